#pragma once

#include <span>

#include "backends/gp_map/engine/engine.hpp"

namespace evbench::gp_map {

/// A landmark that was seen again after it had been out of view.
struct Reappearance {
  int landmark = 0;
  double t = 0.0;                   ///< [s] of the first observation since
  Vector2 pixel = Vector2::Zero();  ///< of that, undistorted [px]
  int last = 0;                     ///< the interval in which it was seen before
};

/// Distance of its image, at the present estimate, from where it was seen [px]; infinite behind the camera.
double reappearance_error(const FactorGraph& graph, const Reappearance& seen);

/// In violent motion a turn of the camera and its way can be taken for one another for a moment, and all that comes
/// into view from then on is placed as the wrong motion says. Gauss-Newton steps do not lead back: landmarks of before,
/// which are seen again beside where they are expected, are outliers to the robust loss. But by chance hardly any two
/// of those would be displaced by the same motion.
///
/// If one motion of the camera explains most of them, and enough, it is supposed to have come about since most of them
/// were seen in their places, in each of some ways (jump_profile.hpp), and the problem is solved from there, at first with the
/// newest pose held. The cheapest stays, if the landmarks do and its cost is not higher by more than these are worth:
/// tracks that were followed wrongly fit the wrong motion. Else the estimate goes back to what it was, but for a
/// Gauss-Newton step, and for landmarks that the engine can't place. Returns whether it stays.
bool correct_pose_jump(Engine& engine, std::span<const Reappearance> seen);

}  // namespace evbench::gp_map
