#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "backends/gp_map/modules/prior_learning.hpp"
#include "backends/gp_map/smoother.hpp"
#include "core/smoother/factors.hpp"

namespace evbench::gp_map {

/// The newest states, smoothed with the prior that they themselves show, with the map and older states held.
///
/// The prior of the smoother's newest intervals has to be weak: the next motion may be aggressive, and a map that is
/// distorted once stays so. Published recent poses need no such caution, because nothing is built on them. So the chain
/// of the last control states, with all their observations, is solved once more: a block-tridiagonal system of the 12
/// unknowns of each, one Gauss-Newton step from the smoother's estimate.
class RecentMotion {
 public:
  /// Without a prior the states stay as the smoother has them.
  explicit RecentMotion(std::optional<RecentPrior> prior) : prior_(std::move(prior)) {}

  /// Call after an update of the smoother. `first_state`: the oldest state that is still estimated.
  void follow(const FactorGraph& graph, int first_state);

  /// An alternative estimate has replaced the published one: the next states depend on the smoother's alone.
  void reset() { states_.clear(); }

  /// In time order, the newest last: those of the last 0.4 s, 24 at most. The smoother's own if nothing can be solved.
  std::span<const ControlState> states() const { return states_; }

 private:
  std::optional<RecentPrior> prior_;
  std::vector<ControlState> states_;
  std::vector<Vector3> positions_;  ///< of landmarks, in the present interval
  IntervalLinearisation linearised_;
};

}  // namespace evbench::gp_map
