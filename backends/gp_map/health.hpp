#pragma once

#include <optional>
#include <string>

#include "backends/gp_map/options.hpp"
#include "core/plugin/status.hpp"

namespace evbench::gp_map {

/// Watches whether the data suffice: spans with too little are `degraded`, with next to nothing for too long it is
/// `lost`.
class Health {
 public:
  explicit Health(const HealthOptions& options) : options_(options) {}

  /// What was seen between the times of two control states.
  void observe(double from, double to, int landmarks);

  /// The estimate can't go on from t.
  void lose(double t, const std::string& reason);

  /// There is no estimate.
  void fail(double t, const std::string& reason);

  bool lost() const { return status_.state == RunState::lost || status_.state == RunState::failed; }
  const Status& status() const { return status_; }

 private:
  void watch_degraded(double from, double to, int landmarks);

  HealthOptions options_;
  Status status_;
  bool in_degraded_ = false;
  std::optional<double> alone_since_;  ///< the prior carries alone from here on
};

}  // namespace evbench::gp_map
