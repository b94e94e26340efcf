#include "frontends/haste/tracking/alignment.hpp"

#include <cmath>

namespace evbench::haste {

Alignment align(const Template& wanted, std::span<const Event> events, const GridState& place) {
  Alignment result{place.x, place.y};
  const Footprints& footprints = Footprints::of(place.angle);
  Template seen;
  for (auto event = events.rbegin(); event != events.rend() && result.event_count < kWindowSize; ++event) {
    const int dx = event->x - place.x, dy = event->y - place.y;
    if (!in_range(dx, dy)) continue;
    seen.add(footprints, Footprints::place(dx, dy), 1.0F);
    ++result.event_count;
  }
  double product = 0.0, wanted_square = 0.0, seen_square = 0.0;
  for (std::size_t i = 0; i < seen.cells().size(); ++i) {
    const double t = wanted.cells()[i], e = seen.cells()[i];
    product += t * e;
    wanted_square += t * t;
    seen_square += e * e;
  }
  const double norm = std::sqrt(wanted_square * seen_square);
  if (norm > 0.0) result.score = product / norm;
  return result;
}

std::vector<Alignment> align_around(const Template& wanted, std::span<const Event> events, const GridState& place,
                                    int radius) {
  std::vector<Event> near;
  const int reach = kPatchRadius + radius;
  for (const Event& event : events) {
    if (std::abs(event.x - place.x) < reach && std::abs(event.y - place.y) < reach) near.push_back(event);
  }
  std::vector<Alignment> result;
  for (int y = -radius; y <= radius; ++y) {
    for (int x = -radius; x <= radius; ++x) result.push_back(align(wanted, near, place + Step{x, y, 0}));
  }
  return result;
}

}  // namespace evbench::haste
