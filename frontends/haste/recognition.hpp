#pragma once

#include <optional>
#include <span>

#include "core/data/track.hpp"
#include "core/events/event.hpp"
#include "frontends/haste/tracking/template.hpp"

namespace evbench::haste {

/// A landmark's appearance when it was tracked: its template, turned by `angle` [rad].
struct KnownLook {
  TrackId track = 0;
  const Template* look = nullptr;
  double angle = 0.0;
};

/// The landmark that is recognised at a position.
struct Recognised {
  TrackId track = 0;
  Vector2 pixel = Vector2::Zero();  ///< where it is [px]
  double angle = 0.0;               ///< by which its template is turned now [rad]
};

/// Compares the events within 3 px of a position with all templates, each turned by up to 36° either way from its
/// stored angle. `window`: the events (in time order) that fill a tracker's window there. None where no score reaches
/// `similarity`, or where a second landmark scores nearly as well.
std::optional<Recognised> recognise(std::span<const KnownLook> looks, std::span<const Event> window,
                                    const Vector2& about, double similarity);

}  // namespace evbench::haste
