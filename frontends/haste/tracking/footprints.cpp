#include "frontends/haste/tracking/footprints.hpp"

#include <cmath>
#include <vector>

namespace evbench::haste {

namespace {

constexpr int kFraction = 32;  // parts of a cell
static_assert(kFraction * kFraction == kUnit);

int wrapped(int angle) {
  const int rest = angle % kAngleSteps;
  return rest < 0 ? rest + kAngleSteps : rest;
}

}  // namespace

Footprint footprint(int dx, int dy, int angle) {
  const double turned = kAngleStep * wrapped(angle), c = std::cos(turned), s = std::sin(turned);
  const long x = std::lround(kFraction * (c * dx + s * dy)) + kFraction * kPatchRadius;
  const long y = std::lround(kFraction * (c * dy - s * dx)) + kFraction * kPatchRadius;
  constexpr long kEnd = kFraction * (kPatchSize - 1);
  if (x < 0 || y < 0 || x >= kEnd || y >= kEnd) return {};
  const int u = static_cast<int>(x % kFraction), v = static_cast<int>(y % kFraction);
  return {patch_cell(static_cast<int>(x / kFraction), static_cast<int>(y / kFraction)),
          {(kFraction - u) * (kFraction - v), u * (kFraction - v), (kFraction - u) * v, u * v}};
}

Footprints::Footprints(int angle) {
  for (int y = 0; y < kSide; ++y) {
    Run& run = runs_[index(y)];
    for (int x = 0; x < kSide; ++x) {
      const Footprint f = footprint(x - kReach - 1, y - kReach - 1, angle);
      const std::size_t i = index(y * kSide + x);
      cells_[i] = static_cast<std::int16_t>(f.cell);
      weights_[i] = f.weights;
      if (!f.inside()) continue;
      if (run.end == 0) run.begin = y * kSide + x;
      run.end = y * kSide + x + 1;
    }
  }
}

const Footprints& Footprints::of(int angle) {
  static const std::vector<Footprints> tables = [] {
    std::vector<Footprints> all;
    all.reserve(kAngleSteps);
    for (int step = 0; step < kAngleSteps; ++step) all.push_back(Footprints(step));
    return all;
  }();
  return tables[index(wrapped(angle))];
}

}  // namespace evbench::haste
