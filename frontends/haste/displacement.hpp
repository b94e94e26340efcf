#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/data/track.hpp"
#include "core/events/event.hpp"
#include "core/geometry/camera.hpp"
#include "frontends/haste/tracking/template.hpp"

namespace evbench::haste {

/// Where a look, as it is expected now, is most like what is seen: within `reach` of a place along each axis, or a
/// pixel more [px], by the newest of the events (in time order). None whose likeness is below `similarity`.
std::optional<Vector2> most_like(const Template& look, std::span<const Event> events, const Vector2& about, int reach,
                                 double similarity);

/// A landmark that is seen beside where it is expected.
struct Displaced {
  TrackId track = 0;
  Vector2 pixel = Vector2::Zero();         ///< where it is, undistorted [px]
  Vector2 displacement = Vector2::Zero();  ///< from where it is expected [px]
  Vector3 point = Vector3::Zero();         ///< the landmark in the camera's frame, as expected
};

/// The most that are where one small motion of the camera that nobody knows of would have displaced them, some by
/// more than `beyond` [px]. None where these are few, or few of all: chance.
std::vector<Displaced> displaced_together(std::span<const Displaced> seen, const PinholeCamera& camera, double beyond);

}  // namespace evbench::haste
