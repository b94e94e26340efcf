#include "frontends/poisson/patch.hpp"

#include "core/simulation/random.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;
using namespace evbench::poisson;

namespace {

constexpr Patch::Shares kGradientAlone = {.any_direction = 0.0, .noise = 0.01, .polarity = true};

/// A patch that is brighter right of its middle has moved to the right by 10 px, 2 OFF events a pixel and row.
Patch brighter_on_the_right() {
  Patch patch(10.0);
  patch.move(Vector2::UnitX(), 10.0, 1000.0);
  for (int i = 0; i < 20; ++i) {
    for (int y = -5; y <= 5; ++y) patch.add({0.0, y}, false, Vector2::UnitX());
  }
  return patch;
}

}  // namespace

TEST_CASE("A patch predicts events where they were, and the other polarity when it moves back") {
  Patch patch = brighter_on_the_right();
  patch.look(Vector2::UnitX(), kGradientAlone);
  CHECK(patch.rate({0.0, 0.0}, false).value > 5.0);
  CHECK(patch.rate({0.0, 0.0}, true).value == Approx(0.01));
  CHECK(patch.rate({5.0, 0.0}, false).value == Approx(0.01));
  CHECK(patch.rate({50.0, 0.0}, false).value == Approx(0.01));
  patch.look(-Vector2::UnitX(), kGradientAlone);
  CHECK(patch.rate({0.0, 0.0}, true).value > 5.0);
  CHECK(patch.rate({0.0, 0.0}, false).value == Approx(0.01));
}

TEST_CASE("Motion along an edge predicts nothing by the gradient, and the place's events by their count") {
  Patch patch = brighter_on_the_right();
  patch.look(Vector2::UnitY(), kGradientAlone);
  CHECK(patch.rate({0.0, 0.0}, false).value == Approx(0.01));
  patch.look(Vector2::UnitY(), {.any_direction = 1.0, .noise = 0.01, .polarity = true});
  CHECK(patch.rate({0.0, 0.0}, false).value > 5.0);
}

TEST_CASE("Without polarity both are expected alike") {
  Patch patch = brighter_on_the_right();
  patch.look(Vector2::UnitX(), {.any_direction = 0.0, .noise = 0.01, .polarity = false});
  CHECK(patch.rate({0.0, 1.0}, true).value == patch.rate({0.0, 1.0}, false).value);
}

TEST_CASE("Two motions give the gradient, and so the rates of a third") {
  // An edge from the lower left to the upper right, with the gradient (1, -1): seen along x and along y.
  Patch patch(10.0);
  for (const auto& [d, on] :
       {std::pair(Vector2(Vector2::UnitX()), false), std::pair(Vector2(Vector2::UnitY()), true)}) {
    patch.move(d, 10.0, 1e9);
    for (int i = -5; i <= 5; ++i) {
      for (int k = 0; k < 10; ++k) patch.add({i, i}, on, d);
    }
  }
  const auto rate = [&](const Vector2& d, bool on) {
    patch.look(d.normalized(), kGradientAlone);
    return patch.rate({0.0, 0.0}, on).value - 0.01;
  };
  const double along_x = rate({1.0, 0.0}, false);
  CHECK(along_x > 1.0);
  CHECK(rate({0.0, 1.0}, true) == Approx(along_x));
  CHECK(rate({1.0, -1.0}, false) == Approx(std::sqrt(2.0) * along_x));
  CHECK(rate({-1.0, 1.0}, true) == Approx(std::sqrt(2.0) * along_x));
  CHECK(rate({1.0, 1.0}, true) == Approx(0.0).margin(1e-6));
}

TEST_CASE("The derivatives of the rate are its differences") {
  Patch patch(8.0);
  Random random(1);
  patch.move(Vector2(0.6, 0.8), 5.0, 100.0);
  for (int i = 0; i < 300; ++i)
    patch.add(random.uniform2({-7.0, -7.0}, {7.0, 7.0}), random.uniform(0, 1) < 0.5, {0.6, 0.8});
  patch.look(Vector2(0.8, 0.6), {.any_direction = 1.0, .noise = 0.3, .polarity = true});
  for (int i = 0; i < 50; ++i) {
    const Vector2 cell(std::floor(random.uniform(-7.0, 6.0)), std::floor(random.uniform(-7.0, 6.0)));
    const Vector2 u = cell + random.uniform2({0.1, 0.1}, {0.9, 0.9});
    const double h = 0.05;
    const Patch::Rate rate = patch.rate(u, true);
    const double dx =
        (patch.rate(u + h * Vector2::UnitX(), true).value - patch.rate(u - h * Vector2::UnitX(), true).value);
    const double dy =
        (patch.rate(u + h * Vector2::UnitY(), true).value - patch.rate(u - h * Vector2::UnitY(), true).value);
    CHECK(rate.x == Approx(dx / (2.0 * h)).margin(2e-4));
    CHECK(rate.y == Approx(dy / (2.0 * h)).margin(2e-4));
  }
}

TEST_CASE("What a patch knew fades with its way, however far") {
  Patch patch = brighter_on_the_right();
  for (int i = 0; i < 200; ++i) {
    patch.move(Vector2::UnitX(), 100.0, 1000.0);
    for (int k = 0; k < 20; ++k) patch.add({4.0, 0.0}, true, Vector2::UnitX());
  }
  patch.look(Vector2::UnitX(), kGradientAlone);
  CHECK(patch.rate({0.0, 0.0}, false).value == Approx(0.01).margin(1e-3));
  CHECK(patch.rate({4.0, 0.0}, true).value > 10.0);
  CHECK(patch.events_per_pixel() == Approx(0.2).epsilon(0.1));
}

TEST_CASE("The mean slope is the sum of the rate's differences over the disc") {
  Patch patch(6.5);
  Random random(2);
  patch.move(Vector2(0.6, 0.8), 5.0, 100.0);
  for (int i = 0; i < 400; ++i) {
    patch.add(random.uniform2({-9.0, -9.0}, {9.0, 9.0}), random.uniform(0, 1) < 0.5, {0.6, 0.8});
  }
  patch.look(Vector2(0.8, 0.6), {.any_direction = 1.0, .noise = 0.3, .polarity = true});
  double mass = 0.0, x = 0.0, y = 0.0, turning = 0.0, growing = 0.0;
  for (int j = -9; j <= 9; ++j) {
    for (int i = -9; i <= 9; ++i) {
      if (i * i + j * j > 6.5 * 6.5) continue;
      for (const bool on : {false, true}) {
        const auto at = [&](int dx, int dy) { return patch.rate({i + dx, j + dy}, on).value; };
        const double gx = 0.5 * (at(1, 0) - at(-1, 0)), gy = 0.5 * (at(0, 1) - at(0, -1));
        mass += at(0, 0);
        x += gx;
        y += gy;
        turning += gx * j - gy * i;
        growing += gx * i + gy * j;
      }
    }
  }
  const Patch::Slope slope = patch.mean_slope();
  CHECK(slope.x == Approx(x / mass).margin(1e-5));
  CHECK(slope.y == Approx(y / mass).margin(1e-5));
  CHECK(slope.turning == Approx(turning / mass).margin(1e-4));
  CHECK(slope.growing == Approx(growing / mass).margin(1e-4));
}
