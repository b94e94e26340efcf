#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/data/track.hpp"
#include "core/events/event.hpp"
#include "frontends/haste/tracking/template.hpp"

namespace evbench::haste {

/// Where a look, as it is expected now, is most like what is seen: within `reach` of a place along each axis, or a
/// pixel more [px], by the newest of the events (in time order). None whose likeness is below `similarity`.
std::optional<Vector2> most_like(const Template& look, std::span<const Event> events, const Vector2& about, int reach,
                                 double similarity);

/// A landmark that is seen beside where it is expected.
struct Displaced {
  TrackId track = 0;
  Vector2 pixel = Vector2::Zero();         ///< where it is [px]
  Vector2 displacement = Vector2::Zero();  ///< from where it is expected [px]
};

/// The most that are displaced by nearly the same way, as by a motion of the camera that nobody knows of, about one
/// that is more than `beyond` [px] aside. None where these are few, or few of all: chance.
std::vector<Displaced> agreeing_displacement(std::span<const Displaced> seen, double beyond);

}  // namespace evbench::haste
