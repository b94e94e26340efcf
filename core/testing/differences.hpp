#pragma once

#include <Eigen/Core>
#include <random>

#include "core/geometry/se3.hpp"

namespace evbench::testing {

/// Central differences of f: R^n → R^m at zero, with one step of Richardson extrapolation (error O(h⁴)).
template <int M, int N, class Function>
Eigen::Matrix<double, M, N> central_differences(Function f, double h = 1e-3) {
  using Input = Eigen::Matrix<double, N, 1>;
  Eigen::Matrix<double, M, N> J;
  for (int column = 0; column < N; ++column) {
    const Input unit = Input::Unit(column);
    const auto slope = [&](double step) -> Eigen::Matrix<double, M, 1> {
      return (f(Input(step * unit)) - f(Input(-step * unit))) / (2.0 * step);
    };
    J.col(column) = (4.0 * slope(0.5 * h) - slope(h)) / 3.0;
  }
  return J;
}

/// Random tangents with rotation angles in [0, π], some of them tiny, zero, or close to π.
class RandomTangents {
 public:
  Vector3 direction() {
    Vector3 v;
    for (double& x : v) x = normal_(generator_);  // in sequence: arguments have no fixed order of evaluation
    return v.normalized();
  }
  double uniform(double from, double to) { return std::uniform_real_distribution<double>(from, to)(generator_); }
  double angle(int i) {
    switch (i % 8) {
      case 0: return 0.0;
      case 1: return uniform(0.0, 1e-9);
      case 2: return uniform(0.0, 1e-4);
      case 3: return M_PI - uniform(2e-3, 1e-2);  // the step of a difference must not wrap around
      case 4: return 1.0 + uniform(-1e-3, 1e-3);  // where the series meets the closed form
      default: return uniform(0.0, M_PI - 1e-2);
    }
  }
  Vector6 tangent(int i) {
    const double rotation = angle(i);
    const Vector3 axis = direction();
    const double distance = uniform(0.0, 3.0);
    return (Vector6() << rotation * axis, distance * direction()).finished();
  }
  SE3 pose() {
    const double angle = uniform(0.0, 3.0);
    const Vector3 axis = direction();
    return se3::exp((Vector6() << angle * axis, 2.0 * direction()).finished());
  }

 private:
  std::mt19937_64 generator_{42};
  std::normal_distribution<double> normal_;
};

/// Largest difference, relative to the largest expected entry if that is above one.
template <class A, class B>
double relative_error(const A& actual, const B& expected) {
  return (actual - expected).cwiseAbs().maxCoeff() / std::max(1.0, expected.cwiseAbs().maxCoeff());
}

}  // namespace evbench::testing
