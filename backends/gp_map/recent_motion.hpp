#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "backends/gp_map/factors.hpp"
#include "backends/gp_map/prior_learning.hpp"

namespace evbench::gp_map {

/// The newest states smoothed with the prior that they themselves show, the map and what is older being held.
///
/// The prior of the engine's newest intervals has to be weak: what comes next may be violent, and a map once bent stays
/// bent. What is told of the last moments needs no such caution, as nothing is built on it. So the chain of the last
/// control states, with all their observations, is solved once more: a block-tridiagonal system of the 12 unknowns of
/// each, one Gauss-Newton step from the engine's estimate.
class RecentMotion {
 public:
  /// Without a prior the states stay as the engine has them.
  explicit RecentMotion(std::optional<RecentPrior> prior) : prior_(std::move(prior)) {}

  /// After an update of the engine, of which `first_state` is the oldest state that is still being estimated.
  void follow(const FactorGraph& graph, int first_state);

  /// Another explanation has replaced what was told: the next states hang on the engine's alone.
  void forget() { states_.clear(); }

  /// In time order, the newest last: those of the last 0.4 s, 24 at most. The engine's own where nothing can be solved.
  std::span<const ControlState> states() const { return states_; }

 private:
  std::optional<RecentPrior> prior_;
  std::vector<ControlState> states_;
  std::vector<Vector3> positions_;  ///< of landmarks, in the interval at hand
  IntervalLinearisation linearised_;
};

}  // namespace evbench::gp_map
