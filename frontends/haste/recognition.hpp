#pragma once

#include <optional>
#include <span>

#include "core/data/track.hpp"
#include "core/events/event.hpp"
#include "frontends/haste/tracking/template.hpp"

namespace evbench::haste {

/// How a landmark looked when it was tracked: its template, turned by `angle` [rad].
struct KnownLook {
  TrackId track = 0;
  const Template* look = nullptr;
  double angle = 0.0;
};

/// The one of the landmarks that is seen at a place.
struct Recognised {
  TrackId track = 0;
  Vector2 pixel = Vector2::Zero();  ///< where it is [px]
  double angle = 0.0;               ///< by which its template is turned now [rad]
};

/// Compares what is seen within 3 px of a place with all the looks, turned by up to 36° more or less than they were, by
/// the events (in time order) that fill a tracker's window there. None whose likeness is at least `similarity`; none
/// where another is nearly as like.
std::optional<Recognised> recognise(std::span<const KnownLook> looks, std::span<const Event> window,
                                    const Vector2& about, double similarity);

}  // namespace evbench::haste
