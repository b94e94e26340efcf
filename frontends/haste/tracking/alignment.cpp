#include "frontends/haste/tracking/alignment.hpp"

#include <algorithm>
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

std::vector<Alignment> align_around(const Template& wanted, std::span<const Event> events, const Pixel& about,
                                    int radius, int step) {
  // A cell of a patch holds as many events as its pixel has had, wherever the patch is. So each event is processed
  // once, for all positions in range of it that are not full yet.
  struct Sum {
    double product = 0.0;
    int square = 0, count = 0;
  };
  const int side = 2 * radius / step + 1, reach = radius + kPatchRadius, width = 2 * reach + 1;
  std::vector<Sum> sums(index(side * side));
  std::vector<int> seen(index(width * width), 0);
  const auto& cells = wanted.cells();
  int open = side * side;
  for (auto event = events.rbegin(); event != events.rend() && open > 0; ++event) {
    const int x = event->x - about.x + reach, y = event->y - about.y + reach;
    if (x < 0 || y < 0 || x >= width || y >= width) continue;
    const int before = seen[index(y * width + x)]++;
    for (int row = std::max(0, (y - 2 * kPatchRadius) / step); row < side && y - row * step > 0; ++row) {
      const int cell_y = y - row * step;
      for (int column = std::max(0, (x - 2 * kPatchRadius) / step); column < side && x - column * step > 0; ++column) {
        const int cell_x = x - column * step;
        Sum& sum = sums[index(row * side + column)];
        if (sum.count == kWindowSize || !in_range(cell_x - kPatchRadius, cell_y - kPatchRadius)) continue;
        sum.product += double{cells[index(patch_cell(cell_x, cell_y))]};
        sum.square += 2 * before + 1;
        if (++sum.count == kWindowSize) --open;
      }
    }
  }
  double square = 0.0;
  for (const float cell : cells) square += double{cell} * double{cell};
  std::vector<Alignment> result;
  for (int i = 0; i < side * side; ++i) {
    const Sum& sum = sums[index(i)];
    const double norm = std::sqrt(square * sum.square);
    result.push_back({about.x - radius + i % side * step, about.y - radius + i / side * step, sum.count,
                      norm > 0.0 ? sum.product / norm : 0.0});
  }
  return result;
}

}  // namespace evbench::haste
