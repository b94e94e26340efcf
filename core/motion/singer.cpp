#include "core/motion/singer.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

namespace evbench::singer {
namespace {

constexpr double kMostRate = 12.0;

/// (u − 1 + e^−u), (1 − e^−u), e^−u
std::array<double, 3> decays(double u) {
  const double rest = -std::expm1(-u);
  if (u > 0.5) return {u - rest, rest, 1.0 - rest};
  double series = 1.0;  // u²/2 (1 − u/3 (1 − u/4 (...))), where the difference would cancel
  for (int n = 16; n > 2; --n) series = 1.0 - u / n * series;
  return {0.5 * u * u * series, rest, 1.0 - rest};
}

/// Nodes and weights of Gauss-Legendre's quadrature on [0, 1] (Newton's method on the Legendre polynomial).
struct Quadrature {
  static constexpr std::size_t kNodes = 20;
  std::array<double, kNodes> at{}, weight{};
  Quadrature() {
    constexpr double n = kNodes;
    for (std::size_t i = 0; i < kNodes; ++i) {
      double x = std::cos(M_PI * (static_cast<double>(i) + 0.75) / (n + 0.5)), slope = 0.0;
      for (int round = 0; round < 8; ++round) {
        double before = 1.0, now = x;
        for (std::size_t k = 2; k <= kNodes; ++k) {
          const auto order = static_cast<double>(k);
          before = std::exchange(now, ((2.0 * order - 1.0) * x * now - (order - 1.0) * before) / order);
        }
        slope = n * (x * now - before) / (x * x - 1.0);
        x -= now / slope;
      }
      at[i] = 0.5 * (1.0 - x);
      weight[i] = 1.0 / ((1.0 - x * x) * slope * slope);
    }
  }
};

/// p_3, p_4, p_5 and the wanted derivatives by s.
std::array<double, 3> functions(const Basis& basis, double s, int derivative) {
  const double z = basis.square * s * s;
  std::array<double, 3> sums{};
  const auto falling = [derivative](double k) { return derivative == 0 ? 1.0 : derivative == 1 ? k : k * (k - 1.0); };
  for (int n = basis.terms; n-- > 0;) {
    const auto i = static_cast<std::size_t>(n);
    sums[1] = sums[1] * z + falling(4.0 + 2.0 * n) * kEven[i];
    sums[2] = sums[2] * z + falling(5.0 + 2.0 * n) * kOdd[i];
  }
  const double power = derivative == 0 ? s * s * s : derivative == 1 ? s * s : s;
  return {falling(3.0) * power, sums[1] * power * s, sums[2] * power * s * s};
}

}  // namespace

double rate_within(double rate, double dt) { return dt > 0.0 ? std::min(rate, kMostRate / dt) : rate; }

Matrix3 transition(double dt, double rate) {
  const auto [position, velocity, acceleration] = decays(rate * dt);
  Matrix3 phi;
  phi << 1.0, dt, position / (rate * rate), 0.0, 1.0, velocity / rate, 0.0, 0.0, acceleration;
  return phi;
}

Matrix3 process_covariance(double dt, double rate) {
  static const Quadrature kQuadrature;
  Matrix3 Q = Matrix3::Zero();
  for (std::size_t i = 0; i < Quadrature::kNodes; ++i) {
    const auto [position, velocity, acceleration] = decays(rate * dt * kQuadrature.at[i]);
    const Vector3 response(position / rate, velocity, rate * acceleration);
    Q += dt * kQuadrature.weight[i] * response * response.transpose();
  }
  return Q;
}

Basis::Basis(double dt_, double rate) : dt(dt_), square(rate * dt * rate * dt) {
  // The first term that is below rounding at the end of the interval, where the series are largest.
  for (double term = 1.0, sum = 1.0; terms < static_cast<int>(kSeriesTerms) && term > 1e-18 * sum; ++terms) {
    const double k = 4.0 + 2.0 * (terms - 1);
    term *= square / ((k + 1.0) * (k + 2.0));
    sum += term;
  }
  Matrix3 at_end;
  for (int derivative = 0; derivative < 3; ++derivative) {
    const auto p = functions(*this, 1.0, derivative);
    at_end.row(derivative) << p[0], p[1], p[2];
  }
  from_end = at_end.inverse() * Vector3(1.0, dt, dt * dt).asDiagonal();
}

InterpolationWeights weights(const Basis& basis, double s, int derivative) {
  const auto p = functions(basis, s, derivative);
  const double dt = basis.dt, scale = derivative == 0 ? 1.0 : derivative == 1 ? 1.0 / dt : 1.0 / (dt * dt);
  const Eigen::RowVector3d w = scale * Eigen::RowVector3d(p[0], p[1], p[2]) * basis.from_end;
  const double linear = derivative == 0 ? s * dt : derivative == 1 ? 1.0 : 0.0;
  const double square = derivative == 0 ? 0.5 * s * s * dt * dt : derivative == 1 ? s * dt : 1.0;
  return {linear - dt * w[0] - w[1], w[0], w[1], square - 0.5 * dt * dt * w[0] - dt * w[1] - w[2], w[2]};
}

}  // namespace evbench::singer
