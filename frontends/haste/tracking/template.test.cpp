#include "frontends/haste/tracking/template.hpp"

#include <limits>

#include "core/testing/catch2.hpp"

using namespace evbench;
using namespace evbench::haste;

namespace {

Template points(const std::vector<std::pair<int, int>>& at) {
  Template result;
  for (const auto& [x, y] : at) result.add(Footprints::of(0), Footprints::place(x, y), 1.0F);
  return result;
}

}  // namespace

TEST_CASE("A template has an event where it fell, spread over four cells when turned, and none from outside") {
  Template made = points({{2, -3}});
  CHECK(made.at(kPatchRadius + 2, kPatchRadius - 3) == 1.0F);
  CHECK(made.mass() == 1.0);
  made.add(Footprints::of(0), Footprints::place(20, 0), 1.0F);
  CHECK(made.mass() == 1.0);
  made.add(Footprints::of(3), Footprints::place(5, 5), 0.5F);
  float sum = 0.0F;
  for (const float cell : made.cells()) sum += cell;
  CHECK(sum == Approx(1.5));
  CHECK(made.mass() == 1.5);
}

TEST_CASE("A warped template has its events turned from x towards y and farther apart") {
  const double quarter = 0.5 * 3.14159265358979323846;
  const Template turned = points({{4, 1}}).warped(quarter, 1.0);
  CHECK(turned.at(kPatchRadius - 1, kPatchRadius + 4) == Approx(1.0));
  const Template magnified = points({{4, 2}, {0, 0}}).warped(0.0, 2.0);
  CHECK(magnified.at(kPatchRadius + 8, kPatchRadius + 4) > 0.1F);
  CHECK(magnified.at(kPatchRadius + 4, kPatchRadius + 2) == 0.0F);
  CHECK(magnified.mass() == 2.0);
}

TEST_CASE("A template that is warped out of the patch, or by no finite scale, is empty") {
  CHECK(points({{10, 10}}).warped(0.0, 5.0).mass() == 0.0);
  CHECK(points({{1, 1}}).warped(0.0, 0.0).mass() == 0.0);
  CHECK(points({{1, 1}}).warped(std::numeric_limits<double>::quiet_NaN(), 1.0).mass() == 0.0);
  CHECK(Template{}.warped(1.0, 1.0).mass() == 0.0);
}
