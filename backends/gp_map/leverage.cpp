#include <algorithm>
#include <vector>

#include "backends/gp_map/gp_map.hpp"

// Bounds the influence of one landmark on the estimate of the camera's position.
namespace evbench::gp_map {
namespace {

constexpr double kLargest = 100.0;    ///< largest bound: such a landmark has no influence
constexpr double kBoundChange = 1.2;  ///< factor by which a bound must change to be updated

}  // namespace

/// The effect of a translation on the image grows with nearness. A track that follows nothing, taken for a landmark
/// close to the camera, has more influence on the translation than all others together, and the estimate then fits it.
/// A robust loss depends on residuals and does not protect against such leverage. Larger sigmas bound it, as Mallows'
/// estimators do, and leave residuals by which such a track is recognised. Sigmas in proportion to nearness do not
/// suffice: translation and rotation move everything at the same distance by nearly the same amount, so a few near
/// landmarks decide between the two.
void GpMap::bound_leverage() {
  const double near = options_.map.leverage;
  if (near == 0.0) return;
  const double median = median_depth();
  const SE3 T_camera_world = graph().states.back().T.inverse();
  std::vector<int> changed;
  for (const auto& group : graph().intervals.back().groups()) {
    const double depth = (T_camera_world * graph().landmarks[index(group.landmark)].position).z();
    if (!(depth > 0.0)) continue;
    const double nearness = std::max(1.0, median / (near * depth));
    const double bound = std::min(kLargest, nearness * nearness);
    double& present = map_->known[index(group.landmark)].leverage;
    if (bound < kBoundChange * present && bound > present / kBoundChange) continue;
    present = bound;
    changed.push_back(group.landmark);
  }
  for (const int j : changed) map_->engine.scale_sigmas(j, map_->known[index(j)].sigma_scale());
}

}  // namespace evbench::gp_map
