#include "motion_prior.hpp"

#include <evbench/plugin_test.hpp>

#include "testing.hpp"

using namespace spline_map;

namespace {

/// A random walk of the velocity with these densities per axis.
Spline random_motion(const MotionDensity& density, int knots, std::mt19937_64& generator) {
  Spline spline(0.0, 0.1, SE3{});
  std::normal_distribution<double> normal;
  Vector6 step = Vector6::Zero();
  while (spline.knots().size() < static_cast<std::size_t>(knots)) {
    for (int i = 0; i < 6; ++i)
      step(i) += std::sqrt((i < 3 ? density.rotation : density.translation) * 1e-3) * normal(generator);
    spline.knots().push_back(spline.knots().back().moved(step));
  }
  return spline;
}

}  // namespace

TEST_CASE("The densities of a random motion are recovered, each in its own period") {
  std::mt19937_64 generator(7);
  const MotionDensity calm{0.01, 0.1};
  const Spline spline = random_motion(calm, 2000, generator);
  const auto estimated = estimate_densities(spline, 1e9, 50.0, {1.0, 1.0}, 1.0);
  CHECK(estimated[1000].rotation == Approx(calm.rotation).epsilon(0.2));
  CHECK(estimated[1000].translation == Approx(calm.translation).epsilon(0.2));
}

TEST_CASE("Without knots to estimate from, the expected densities remain") {
  const Spline spline(0.0, 0.1, SE3{});
  for (const MotionDensity& density : estimate_densities(spline, -1.0, 1.0, {0.3, 0.7}, 2.0)) {
    CHECK(density.rotation == Approx(0.3));
    CHECK(density.translation == Approx(0.7));
  }
}
