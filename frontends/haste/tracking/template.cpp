#include "frontends/haste/tracking/template.hpp"

#include <cmath>

#include "frontends/haste/tracking/hypothesis_lanes.hpp"

namespace evbench::haste {

void Template::add(const Footprints& footprints, int place, float weight) {
  const Double4 weights = __builtin_convertvector(quad(footprints.weights(place)), Double4);
  if (weights[0] == 0.0 && weights[1] == 0.0 && weights[2] == 0.0 && weights[3] == 0.0) return;
  // Products of a float and a weight are exact in double: the same with and without fused multiply-add.
  float* cell = &cells_[index(footprints.cell(place))];
  const Double4 sum = __builtin_convertvector(Block<float>::load(cell), Double4) + (double{weight} / kUnit) * weights;
  Block<float>::store(cell, __builtin_convertvector(sum, Float4));
  mass_ += double{weight};
}

Template Template::warped(double angle, double scale) const {
  const auto value = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < kPatchSize && y < kPatchSize ? double{at(x, y)} : 0.0;
  };
  const double c = std::cos(angle) / scale, s = std::sin(angle) / scale;
  std::array<double, kPatchCells> cells{};
  double sum = 0.0;
  for (int y = 0; y < kPatchSize; ++y) {
    for (int x = 0; x < kPatchSize; ++x) {
      const double dx = x - kPatchRadius, dy = y - kPatchRadius;
      const double from_x = c * dx + s * dy + kPatchRadius, from_y = c * dy - s * dx + kPatchRadius;
      if (!(std::abs(from_x) < 2.0 * kPatchSize && std::abs(from_y) < 2.0 * kPatchSize)) continue;
      const int left = static_cast<int>(std::floor(from_x)), top = static_cast<int>(std::floor(from_y));
      const double u = from_x - left, v = from_y - top;
      double& cell = cells[index(patch_cell(x, y))];
      cell = (1.0 - v) * ((1.0 - u) * value(left, top) + u * value(left + 1, top)) +
             v * ((1.0 - u) * value(left, top + 1) + u * value(left + 1, top + 1));
      sum += cell;
    }
  }
  Template result;
  if (!(sum > 0.0)) return result;
  for (std::size_t i = 0; i < cells.size(); ++i) result.cells_[i] = static_cast<float>(cells[i] * (mass_ / sum));
  result.mass_ = mass_;
  return result;
}

}  // namespace evbench::haste
