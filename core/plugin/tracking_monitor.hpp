#pragma once

#include <optional>
#include <string>

#include "core/plugin/exchange.hpp"
#include "core/plugin/status.hpp"

namespace evbench {

/// The rule by which every back-end tells degraded and lost: a span with too little data is `degraded`, whatever still
/// determines the motion there; when for longer than the patience nothing but a motion model carries the estimate, it
/// is `lost` from the beginning of that span on.
class TrackingMonitor {
 public:
  explicit TrackingMonitor(double patience) : patience_(patience) {}

  enum class Support {
    full,  ///< observations determine the motion
    weak,  ///< they contribute, but are too few to be relied on
    none,  ///< a motion model alone
  };

  /// There is a map; what carried the estimate between two times. `reason` says what is missing, where it isn't full.
  void observe(double from, double to, Support support, const std::string& reason = {});

  /// Another map, found just now, determines the motion from `since` on: the degraded span at hand ends there.
  void recovered(double since);

  /// The estimate can't go on from t.
  void lose(double t, const std::string& reason);

  /// There is no estimate.
  void fail(double t, const std::string& reason);

  bool lost() const { return status_.state == RunState::lost || status_.state == RunState::failed; }
  TrackingState state() const;
  const Status& status() const { return status_; }

 private:
  void degrade(double from, double to, const std::string& reason);

  double patience_;
  Status status_;
  bool has_map_ = false, in_degraded_ = false;
  std::optional<double> alone_since_;  ///< a motion model carries alone from here on
};

}  // namespace evbench
