#pragma once

#include <optional>
#include <vector>

#include "backends/gp_map/options.hpp"

namespace evbench::gp_map {

/// Decides at which times control states stand, from the times of the observations alone, so that a run does not depend
/// on the pieces in which its observations arrive.
class StatePlacement {
 public:
  explicit StatePlacement(const PlacementOptions& options) : options_(options) {}

  /// Times of observations, in order.
  void observe(double t);

  /// The first state stands at the first observation. The time of the next one, when it is known and ≤ now.
  std::optional<double> next(double now);

  /// The state that closes the trajectory: at or after the last observation. None when there is one already.
  std::optional<double> last();

 private:
  PlacementOptions options_;
  std::vector<double> times_;  // of observations after the newest state
  std::optional<double> first_, newest_;
  std::int64_t count_ = 0;  // states placed
  std::optional<double> last_observation_;

  std::optional<double> by_rate(double now) const;
  std::optional<double> by_observations(double now) const;
  void place(double t);
};

}  // namespace evbench::gp_map
