#pragma once

#include <span>
#include <vector>

#include "core/events/event.hpp"
#include "frontends/haste/tracking/template.hpp"

namespace evbench::haste {

/// How well a template explains the newest events around a place.
struct Alignment {
  int x = 0, y = 0;     ///< the place [px]
  int event_count = 0;  ///< in range of it, at most kWindowSize
  /// Cosine between the template and the events, both as images: Σ T·E / √(ΣT² ΣE²), in [0, 1]; 0 without events.
  double score = 0.0;
};

/// The template, turned by so many steps of angle, at a place, with the newest kWindowSize of the events (in time
/// order) in range.
Alignment align(const Template& wanted, std::span<const Event> events, const GridState& place);

/// The same at all whole pixels no further than `radius` from a place along each axis, row by row.
std::vector<Alignment> align_around(const Template& wanted, std::span<const Event> events, const GridState& place,
                                    int radius);

}  // namespace evbench::haste
