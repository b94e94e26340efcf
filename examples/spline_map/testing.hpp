#pragma once

#include <array>
#include <evbench/plugin.hpp>
#include <random>

#include "spline_segment.hpp"

namespace spline_map::testing {

/// Central differences of f: R^n → R^m at zero, with one step of Richardson extrapolation.
template <int M, int N, class Function>
Eigen::Matrix<double, M, N> differences(Function f) {
  using Input = Eigen::Matrix<double, N, 1>;
  constexpr double kH = 1e-3;
  Eigen::Matrix<double, M, N> J;
  for (int column = 0; column < N; ++column) {
    const auto slope = [&](double step) -> Eigen::Matrix<double, M, 1> {
      return (f(Input(step * Input::Unit(column))) - f(Input(-step * Input::Unit(column)))) / (2.0 * step);
    };
    J.col(column) = (4.0 * slope(0.5 * kH) - slope(kH)) / 3.0;
  }
  return J;
}

inline Vector3 random_vector(std::mt19937_64& generator, double size) {
  std::uniform_real_distribution coordinate(-size, size);
  const double x = coordinate(generator), y = coordinate(generator);
  return {x, y, coordinate(generator)};
}

/// Random knots; neighbours are rotated by up to about 2 rad, in some draws by zero or almost zero.
template <std::size_t N>
std::array<Knot, N> random_knots(std::mt19937_64& generator, int draw) {
  const double turn = draw % 4 == 0 ? 0.0 : draw % 4 == 1 ? 1e-6 : draw % 4 == 2 ? 0.1 : 1.2;
  std::array<Knot, N> knots;
  Eigen::Quaterniond rotation = evbench::so3::exp(random_vector(generator, 1.5));
  for (Knot& knot : knots) {
    knot = Knot(rotation, random_vector(generator, 1.0));
    rotation = (rotation * evbench::so3::exp(random_vector(generator, turn))).normalized();
  }
  return knots;
}

inline SplineSegment segment(const std::array<Knot, 4>& knots) { return {knots[0], knots[1], knots[2], knots[3]}; }

}  // namespace spline_map::testing
