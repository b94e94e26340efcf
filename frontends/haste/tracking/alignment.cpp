#include "frontends/haste/tracking/alignment.hpp"

#include <cmath>

namespace evbench::haste {

Sight sight(std::span<const Event> events, const GridState& place) {
  Sight result;
  const Footprints& footprints = Footprints::of(place.angle);
  for (auto event = events.rbegin(); event != events.rend() && result.event_count < kWindowSize; ++event) {
    const int dx = event->x - place.x, dy = event->y - place.y;
    if (!in_range(dx, dy)) continue;
    result.patch.add(footprints, Footprints::place(dx, dy), 1.0F);
    ++result.event_count;
  }
  return result;
}

double likeness(const Template& a, const Template& b) {
  double product = 0.0, a_square = 0.0, b_square = 0.0;
  for (std::size_t i = 0; i < a.cells().size(); ++i) {
    const double x = a.cells()[i], y = b.cells()[i];
    product += x * y;
    a_square += x * x;
    b_square += y * y;
  }
  const double norm = std::sqrt(a_square * b_square);
  return norm > 0.0 ? product / norm : 0.0;
}

Alignment align(const Template& wanted, std::span<const Event> events, const GridState& place) {
  const Sight seen = sight(events, place);
  return {place.x, place.y, seen.event_count, likeness(wanted, seen.patch)};
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
