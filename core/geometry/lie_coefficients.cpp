#include "core/geometry/lie_coefficients.hpp"

#include <array>
#include <cmath>
#include <cstddef>

namespace evbench {
namespace {

constexpr double kSeriesBelow = 1.0;  // θ² up to which the series below is exact to rounding

template <std::size_t N>
CoefficientJet series(const std::array<double, N>& coefficients, double z) {
  CoefficientJet jet;
  for (std::size_t k = N; k-- > 0;) {  // Horner, with derivatives
    jet.ddd = jet.ddd * z + 3.0 * jet.dd;
    jet.dd = jet.dd * z + 2.0 * jet.d;
    jet.d = jet.d * z + jet.f;
    jet.f = jet.f * z + coefficients[k];
  }
  return jet;
}

/// Coefficients of Σ (−z)^n / (2n + first)!
std::array<double, 12> alternating_factorials(int first) {
  std::array<double, 12> result{};
  double factorial = 1.0;
  for (int k = 2; k <= first; ++k) factorial *= k;
  double sign = 1.0;
  for (std::size_t n = 0; n < result.size(); ++n) {
    result[n] = sign / factorial;
    sign = -sign;
    const double k = static_cast<double>(first) + 2.0 * static_cast<double>(n);
    factorial *= (k + 1.0) * (k + 2.0);
  }
  return result;
}

/// h(z) = Σ |B_2n|/(2n)! z^(n−1), by |B_2n|/(2n)! = 2 ζ(2n)/(2π)^2n.
std::array<double, 16> bernoulli_ratios() {
  constexpr double kTwoPiSquared = 4.0 * M_PI * M_PI;
  std::array<double, 16> result{};
  double power = kTwoPiSquared;
  for (std::size_t n = 0; n < result.size(); ++n) {
    result[n] = 2.0 * std::riemann_zeta(2.0 * static_cast<double>(n + 1)) / power;
    power *= kTwoPiSquared;
  }
  return result;
}

/// sin θ / θ
CoefficientJet sinc(double z) {
  const double theta = std::sqrt(z);
  CoefficientJet a;
  a.f = std::sin(theta) / theta;
  a.d = (std::cos(theta) - a.f) / (2.0 * z);
  a.dd = (-0.5 * a.f - 3.0 * a.d) / (2.0 * z);
  a.ddd = (-0.5 * a.d - 5.0 * a.dd) / (2.0 * z);
  return a;
}

}  // namespace

CoefficientJet coefficient_b(double z) {
  static const auto kSeries = alternating_factorials(2);
  if (z < kSeriesBelow) return series(kSeries, z);
  const CoefficientJet a = sinc(z);
  CoefficientJet b;
  b.f = (1.0 - std::cos(std::sqrt(z))) / z;
  b.d = (a.f - 2.0 * b.f) / (2.0 * z);
  b.dd = (a.d - 4.0 * b.d) / (2.0 * z);
  b.ddd = (a.dd - 6.0 * b.dd) / (2.0 * z);
  return b;
}

CoefficientJet coefficient_c(double z) {
  static const auto kSeries = alternating_factorials(3);
  if (z < kSeriesBelow) return series(kSeries, z);
  const CoefficientJet b = coefficient_b(z);
  CoefficientJet c;
  c.f = (1.0 - sinc(z).f) / z;
  c.d = (b.f - 3.0 * c.f) / (2.0 * z);
  c.dd = (b.d - 5.0 * c.d) / (2.0 * z);
  c.ddd = (b.dd - 7.0 * c.dd) / (2.0 * z);
  return c;
}

CoefficientJet inverse_jacobian_coefficient(double z) {
  static const auto kSeries = bernoulli_ratios();
  if (z < kSeriesBelow) return series(kSeries, z);
  const CoefficientJet a = sinc(z);
  const CoefficientJet b = coefficient_b(z);
  CoefficientJet f;  // (θ/2) cot(θ/2) = a / (2 b)
  f.f = a.f / (2.0 * b.f);
  f.d = (a.d - 2.0 * f.f * b.d) / (2.0 * b.f);
  f.dd = (a.dd - 4.0 * f.d * b.d - 2.0 * f.f * b.dd) / (2.0 * b.f);
  f.ddd = (a.ddd - 6.0 * f.dd * b.d - 6.0 * f.d * b.dd - 2.0 * f.f * b.ddd) / (2.0 * b.f);
  CoefficientJet h;
  h.f = (1.0 - f.f) / z;
  h.d = (-f.d - h.f) / z;
  h.dd = (-f.dd - 2.0 * h.d) / z;
  h.ddd = (-f.ddd - 3.0 * h.dd) / z;
  return h;
}

}  // namespace evbench
