#include "frontends/haste/recent_events.hpp"

#include <cmath>

#include "frontends/haste/tracking/hypotheses.hpp"

namespace evbench::haste {

std::span<const Event> window_at(const Vector2& pixel, const RecentEvents& recent) {
  const std::span<const Event> all = recent.events();
  const int x = static_cast<int>(std::lround(pixel.x())), y = static_cast<int>(std::lround(pixel.y()));
  std::size_t first = all.size();
  for (int missing = kWindowSize; missing > 0 && first > 0;) {
    const Event& event = all[--first];
    if (in_range(event.x - x, event.y - y)) --missing;
  }
  return all.subspan(first);
}

}  // namespace evbench::haste
