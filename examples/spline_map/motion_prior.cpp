#include "motion_prior.hpp"

#include <algorithm>
#include <cmath>
#include <evbench/plugin.hpp>

namespace spline_map {

std::vector<MotionDensity> estimate_densities(const Spline& spline, double t_end, double radius,
                                              const MotionDensity& expected, double weight) {
  const std::vector<Knot>& knots = spline.knots();
  const std::size_t count = knots.size();
  const double cube = spline.spacing() * spline.spacing() * spline.spacing();
  // Prefix sums over the knots; only inner knots have an acceleration.
  std::vector<MotionDensity> sums(count + 1, {0.0, 0.0});
  std::vector<double> numbers(count + 1, 0.0);
  for (std::size_t k = 0; k < count; ++k) {
    sums[k + 1] = sums[k];
    numbers[k + 1] = numbers[k];
    if (k == 0 || k + 1 == count || spline.knot_time(k + 1) > t_end) continue;
    const Vector3 d1 = evbench::so3::log(knots[k - 1].rotation().conjugate() * knots[k].rotation());
    const Vector3 d2 = evbench::so3::log(knots[k].rotation().conjugate() * knots[k + 1].rotation());
    const Vector3 shift = knots[k + 1].position() - 2.0 * knots[k].position() + knots[k - 1].position();
    sums[k + 1].rotation += (d2 - d1).squaredNorm() / (3.0 * cube);
    sums[k + 1].translation += shift.squaredNorm() / (3.0 * cube);
    numbers[k + 1] += 1.0;
  }
  const auto reach = static_cast<std::size_t>(std::ceil(radius / spline.spacing()));
  std::vector<MotionDensity> result(count);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t from = k > reach ? k - reach : 0, to = std::min(count, k + reach + 1);
    const double number = numbers[to] - numbers[from] + weight;
    result[k].rotation = (sums[to].rotation - sums[from].rotation + weight * expected.rotation) / number;
    result[k].translation = (sums[to].translation - sums[from].translation + weight * expected.translation) / number;
  }
  return result;
}

}  // namespace spline_map
