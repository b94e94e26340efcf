#include "frontends/haste/tracking/footprints.hpp"

#include <cmath>

#include "core/testing/catch2.hpp"

using namespace evbench;
using namespace evbench::haste;

TEST_CASE("In an upright patch an event is in the cell as far from the middle as the event is from the tracker") {
  const Footprint f = footprint(3, -4, 0);
  CHECK(f.cell == patch_cell(kPatchRadius + 3, kPatchRadius - 4));
  CHECK(f.weights == std::array{kUnit, 0, 0, 0});
  CHECK(footprint(-15, -15, 0).cell == 0);
  CHECK(footprint(14, 14, 0).inside());
  CHECK_FALSE(footprint(15, 0, 0).inside());  // the published rule: less than the last cell
  CHECK_FALSE(footprint(-16, 0, 0).inside());
}

TEST_CASE("In a patch turned by half a turn events are on the other side, in whichever direction it was turned") {
  for (const int angle : {kAngleSteps / 2, -kAngleSteps / 2, 5 * kAngleSteps / 2}) {
    const Footprint f = footprint(3, -4, angle);
    CHECK(f.cell == patch_cell(kPatchRadius - 3, kPatchRadius + 4));
    CHECK(f.weights == std::array{kUnit, 0, 0, 0});
  }
}

TEST_CASE("Weights are bilinear to 1/32 of a cell and their sum is always the same") {
  for (int angle = 0; angle < kAngleSteps; ++angle) {
    const double c = std::cos(kAngleStep * angle), s = std::sin(kAngleStep * angle);
    for (int dy = -14; dy <= 14; ++dy) {
      for (int dx = -14; dx <= 14; ++dx) {
        if (!in_range(dx, dy)) continue;
        const Footprint f = footprint(dx, dy, angle);
        const auto& w = f.weights;
        REQUIRE(w[0] + w[1] + w[2] + w[3] == kUnit);
        const double x = f.cell % kPatchStride + double(w[1] + w[3]) / kUnit - kPatchRadius;
        const double y = f.cell / kPatchStride + double(w[2] + w[3]) / kUnit - kPatchRadius;
        REQUIRE(x == Approx(c * dx + s * dy).margin(1.0 / 64 + 1e-9));
        REQUIRE(y == Approx(c * dy - s * dx).margin(1.0 / 64 + 1e-9));
      }
    }
  }
}

TEST_CASE("Tables have the footprints of all positions in any hypothesis' patch, and nothing beyond") {
  for (const int angle : {0, 11, 44, -3}) {
    const Footprints& table = Footprints::of(angle);
    for (int dy = -40; dy <= 40; ++dy) {
      for (int dx = -40; dx <= 40; ++dx) {
        for (const Step& step : kSteps) {
          if (step.angle != 0) continue;
          const int place = Footprints::place(dx, dy) + Footprints::shift(step);
          const Footprint expected = footprint(dx - step.x, dy - step.y, angle);
          REQUIRE(table.weights(place) == expected.weights);
          if (expected.inside()) REQUIRE(table.cell(place) == expected.cell);
        }
      }
    }
  }
}
