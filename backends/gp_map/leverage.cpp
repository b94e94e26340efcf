#include <algorithm>
#include <vector>

#include "backends/gp_map/gp_map.hpp"

// How much one landmark may say of where the camera is.
namespace evbench::gp_map {
namespace {

constexpr double kNear = 1.5;         ///< times nearer than the scene's median depth: bounded from there on
constexpr double kLargest = 100.0;    ///< bound: such a landmark says nothing
constexpr double kBoundChange = 1.2;  ///< by which a bound must change to be set anew

}  // namespace

/// What a translation does to the image grows with nearness. A track that follows nothing, taken for a landmark close
/// before the camera, says more of the translation than all others together, and the estimate then fits it: a robust
/// loss, which looks at residuals, protects from no such leverage. Larger sigmas bound it, as Mallows' estimators do,
/// and leave residuals by which such a track is told. In proportion to nearness they would not do: translation and
/// rotation move all that is equally far by nearly the same, so a little that is near decides between the two.
void GpMap::bound_leverage() {
  const double median = median_depth();
  const SE3 T_camera_world = graph().states.back().T.inverse();
  std::vector<int> changed;
  for (const auto& group : graph().intervals.back().groups()) {
    const double depth = (T_camera_world * graph().landmarks[index(group.landmark)].position).z();
    if (!(depth > 0.0)) continue;
    const double nearness = std::max(1.0, median / (kNear * depth));
    const double bound = std::min(kLargest, nearness * nearness);
    double& present = map_->known[index(group.landmark)].leverage;
    if (bound < kBoundChange * present && bound > present / kBoundChange) continue;
    present = bound;
    changed.push_back(group.landmark);
  }
  for (const int j : changed) map_->engine.scale_sigmas(j, map_->known[index(j)].sigma_scale());
}

}  // namespace evbench::gp_map
