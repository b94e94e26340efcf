#pragma once

#include <span>

#include "backends/gp_map/engine/engine.hpp"

namespace evbench::gp_map {

/// A landmark that was re-acquired after it had been out of view.
struct Reappearance {
  int landmark = 0;
  double t = 0.0;                   ///< [s] of the first observation since then
  Vector2 pixel = Vector2::Zero();  ///< of this observation, undistorted [px]
  int last = 0;                     ///< the last interval in which it was seen before
};

/// Distance of the landmark's image at the present estimate from this observation [px]; infinite behind the camera.
double reappearance_error(const FactorGraph& graph, const Reappearance& seen);

/// Corrects a pose jump. In aggressive motion rotation and translation of the camera can be confused for a moment, and
/// all new landmarks are placed according to the wrong motion. Gauss-Newton steps do not lead back: old landmarks that
/// are re-acquired off their expected places are outliers to the robust loss. But hardly any two outliers are displaced
/// by the same motion by chance.
///
/// If one motion of the camera explains most of the displaced landmarks, and enough of them, it is assumed to have
/// happened since most of them were last seen in their places, with each of some time profiles (jump_profile.hpp). The
/// problem is solved from each of them, at first with the newest pose held. The cheapest solution is kept if the
/// landmarks are in their places and its cost is not too high; an increase per landmark is allowed, because wrongly
/// followed tracks fit the wrong motion. Otherwise the previous estimate is restored, except for a Gauss-Newton step
/// and for landmarks that the engine cannot set. Returns whether a solution was kept.
bool correct_pose_jump(Engine& engine, std::span<const Reappearance> seen);

}  // namespace evbench::gp_map
