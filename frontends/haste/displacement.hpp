#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/data/track.hpp"
#include "core/events/event.hpp"
#include "core/geometry/camera.hpp"
#include "frontends/haste/tracking/template.hpp"

namespace evbench::haste {

/// Searches for the position at which the newest of the events (in time order) match a template best. `look` is the
/// template as it is expected now. The search covers `reach` px (or one more) along each axis around `about`. None
/// where the best score is below `similarity`.
std::optional<Vector2> most_like(const Template& look, std::span<const Event> events, const Vector2& about, int reach,
                                 double similarity);

/// A landmark that is observed off its expected position.
struct Displaced {
  TrackId track = 0;
  Vector2 pixel = Vector2::Zero();         ///< where it is, undistorted [px]
  Vector2 displacement = Vector2::Zero();  ///< from its expected position [px]
  Vector3 point = Vector3::Zero();         ///< the landmark in the camera's frame, as expected
};

/// The largest set of landmarks whose displacements one small unmodelled camera motion explains, where it displaces
/// some of them by more than `beyond` [px]. Empty where the set is small, or a small share of all: that is chance.
std::vector<Displaced> displaced_together(std::span<const Displaced> seen, const PinholeCamera& camera, double beyond);

}  // namespace evbench::haste
