#include "backends/gp_map/modules/leverage_bound.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace evbench::gp_map {

void LeverageOptions::declare(OptionSet& set) {
  set.add("enabled", enabled, "landmarks that are much nearer than most get larger sigmas");
  set.add("nearness", nearness,
          "how many times nearer than the scene's median depth; beyond it, sigmas grow with the square of the nearness")
      .above(0.0);
  set.add("most", most, "factor of the sigmas, at most: such a landmark has no influence").range(1.0);
}

void LeverageBound::apply(Estimate& estimate) const {
  constexpr double kChange = 1.2;  // smaller changes are not worth the work of an update
  if (!options_.enabled) return;
  const double median = estimate.median_depth();
  const SE3 T_camera_world = estimate.newest().T.inverse();
  std::vector<std::pair<int, double>> changed;
  for (const auto& group : estimate.graph().intervals.back().groups()) {
    const double depth = (T_camera_world * estimate.graph().landmarks[index(group.landmark)].position).z();
    if (!(depth > 0.0)) continue;
    const double nearness = std::max(1.0, median / (options_.nearness * depth));
    const double bound = std::min(options_.most, nearness * nearness), present = estimate.leverage(group.landmark);
    if (bound < kChange * present && bound > present / kChange) continue;
    changed.emplace_back(group.landmark, bound);
    if (present == 1.0) estimate.count(Count::leverage_bounded);
  }
  for (const auto& [landmark, bound] : changed) estimate.set_leverage(landmark, bound);
}

}  // namespace evbench::gp_map
