#pragma once

#include <span>
#include <vector>

#include "core/events/event.hpp"
#include "frontends/haste/tracking/template.hpp"

namespace evbench::haste {

/// A patch at a position, turned by a number of steps of angle, made of the newest kWindowSize events in range.
struct Sight {
  Template patch;
  int event_count = 0;
};
/// The events in time order.
Sight sight(std::span<const Event> events, const GridState& place);

/// Cosine between two patches as images: Σ A·B / √(ΣA² ΣB²), in [0, 1]; 0 where one is empty.
double likeness(const Template& a, const Template& b);

/// How well a template explains the newest events around a position.
struct Alignment {
  int x = 0, y = 0;     ///< the position [px]
  int event_count = 0;  ///< in range of the position, at most kWindowSize
  double score = 0.0;   ///< likeness of the template and the events' patch
};

/// Compares a template, at a position and turned by a number of steps of angle, with the newest kWindowSize events in
/// range. The events come in time order.
Alignment align(const Template& wanted, std::span<const Event> events, const GridState& place);

/// One of the image's pixels.
struct Pixel {
  int x = 0, y = 0;
};
/// align() with the template not turned, at every `step`th pixel within `radius` of `about` along each axis, row by
/// row: many times faster than one by one.
std::vector<Alignment> align_around(const Template& wanted, std::span<const Event> events, const Pixel& about,
                                    int radius, int step = 1);

}  // namespace evbench::haste
