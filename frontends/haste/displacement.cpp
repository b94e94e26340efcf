#include "frontends/haste/displacement.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <utility>

#include "frontends/haste/tracking/alignment.hpp"

namespace evbench::haste {

std::optional<Vector2> most_like(const Template& look, std::span<const Event> events, const Vector2& about, int reach,
                                 double similarity) {
  constexpr int kStep = 2;  // [px] between places that are compared at first
  const GridState place{static_cast<int>(std::lround(about.x())), static_cast<int>(std::lround(about.y())), 0};
  std::vector<Event> near;
  for (const Event& event : events) {
    const int farthest = std::max(std::abs(event.x - place.x), std::abs(event.y - place.y));
    if (farthest < kPatchRadius + reach + kStep) near.push_back(event);
  }
  std::vector<Alignment> places;
  for (int y = -reach; y <= reach; y += kStep) {
    for (int x = -reach; x <= reach; x += kStep) {
      const Alignment seen = align(look, near, place + Step{x, y, 0});
      if (seen.event_count == kWindowSize) places.push_back(seen);
    }
  }
  const auto best = std::ranges::max_element(places, {}, &Alignment::score);
  if (best == places.end() || best->score < similarity) return std::nullopt;
  const std::vector<Alignment> between = align_around(look, near, {best->x, best->y, 0}, kStep - 1);
  const auto exact = std::ranges::max_element(between, {}, &Alignment::score);
  return Vector2(exact->x, exact->y);
}

std::vector<Displaced> agreeing_displacement(std::span<const Displaced> seen, double beyond) {
  constexpr double kNearly = 4.0;  // [px]
  constexpr std::size_t kEnough = 5;
  constexpr std::size_t kShare = 3;  // one in so many of all, at least
  std::vector<Displaced> result;
  for (const Displaced& middle : seen) {
    if (middle.displacement.norm() <= beyond) continue;
    std::vector<Displaced> agreeing;
    std::ranges::copy_if(seen, std::back_inserter(agreeing), [&](const Displaced& other) {
      return (other.displacement - middle.displacement).norm() <= kNearly;
    });
    if (agreeing.size() > result.size()) result = std::move(agreeing);
  }
  if (result.size() < kEnough || kShare * result.size() < seen.size()) result.clear();
  return result;
}

}  // namespace evbench::haste
