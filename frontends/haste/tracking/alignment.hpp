#pragma once

#include <span>
#include <vector>

#include "core/events/event.hpp"
#include "frontends/haste/tracking/template.hpp"

namespace evbench::haste {

/// The newest kWindowSize of some events in range of a place, as a patch there that is turned by so many steps of
/// angle.
struct Sight {
  Template patch;
  int event_count = 0;
};
/// The events in time order.
Sight sight(std::span<const Event> events, const GridState& place);

/// Cosine between two patches as images: Σ A·B / √(ΣA² ΣB²), in [0, 1]; 0 where one is empty.
double likeness(const Template& a, const Template& b);

/// How well a template explains the newest events around a place.
struct Alignment {
  int x = 0, y = 0;     ///< the place [px]
  int event_count = 0;  ///< in range of it, at most kWindowSize
  double score = 0.0;   ///< likeness of the template and what is seen there
};

/// The template, turned by so many steps of angle, at a place, with the newest kWindowSize of the events (in time
/// order) in range.
Alignment align(const Template& wanted, std::span<const Event> events, const GridState& place);

/// One of the image's pixels.
struct Pixel {
  int x = 0, y = 0;
};
/// The same, not turned, at every `step`th pixel from `radius` before one to no more than that beyond it along each
/// axis, row by row: many times faster than one by one.
std::vector<Alignment> align_around(const Template& wanted, std::span<const Event> events, const Pixel& about,
                                    int radius, int step = 1);

}  // namespace evbench::haste
