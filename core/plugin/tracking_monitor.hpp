#pragma once

#include <optional>
#include <string>

#include "core/plugin/exchange.hpp"
#include "core/plugin/status.hpp"

namespace evbench {

/// The common rule of all back-ends for degraded and lost tracking. A span with too little data is `degraded`. When the
/// motion model alone carries the estimate for longer than the patience, tracking is `lost` from the beginning of that
/// span.
class TrackingMonitor {
 public:
  explicit TrackingMonitor(double patience) : patience_(patience) {}

  enum class Support {
    full,  ///< observations determine the motion
    weak,  ///< observations contribute but are too few to rely on
    none,  ///< the motion model alone
  };

  /// Reports what supports the estimate between two times [s], once there is a map. `reason` says what is missing if
  /// the support is not full.
  void observe(double from, double to, Support support, const std::string& reason = {});

  /// Reports a new map that determines the motion from `since` [s] on: the current degraded span ends there.
  void recovered(double since);

  /// Reports that the estimate between two times [s] is doubtful although observations support it.
  void doubt(double from, double to, const std::string& reason);

  /// Reports that the estimate cannot continue after t [s].
  void lose(double t, const std::string& reason);

  /// Reports that there is no estimate.
  void fail(double t, const std::string& reason);

  bool lost() const { return status_.state == RunState::lost || status_.state == RunState::failed; }
  TrackingState state() const;
  const Status& status() const { return status_; }

 private:
  void degrade(double from, double to, const std::string& reason);

  double patience_;
  Status status_;
  bool has_map_ = false, in_degraded_ = false;
  std::optional<double> alone_since_;  ///< [s] since then the motion model alone carries the estimate
};

}  // namespace evbench
