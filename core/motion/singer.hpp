#pragma once

#include <array>
#include <cstddef>

#include "core/geometry/types.hpp"
#include "core/motion/motion_prior.hpp"

namespace evbench {

/// Singer's prior (motion_prior.hpp) of one axis for Qc = 1. States are (position, velocity, acceleration).
namespace singer {

/// The rate that counts in an interval: at most 12 a length of it. A faster one differs from white noise on
/// acceleration only in the first twelfth, and exp(α Δt) would exceed what double precision can resolve.
double rate_within(double rate, double dt);

/// Φ(dt): the expected state after dt [s].
Matrix3 transition(double dt, double rate);

/// Q(dt): covariance that accumulates over dt [s].
Matrix3 process_covariance(double dt, double rate);

/// Power series Σ k!/(k + 2n)! z^n of the functions below, for z ≤ 144.
inline constexpr std::size_t kSeriesTerms = 28;
template <int K>
constexpr std::array<double, kSeriesTerms> factorial_ratios() {
  std::array<double, kSeriesTerms> result{};
  double term = 1.0;
  for (std::size_t n = 0; n < kSeriesTerms; ++n) {
    result[n] = term;
    const double k = K + 2.0 * static_cast<double>(n);
    term /= (k + 1.0) * (k + 2.0);
  }
  return result;
}
inline constexpr auto kEven = factorial_ratios<4>();
inline constexpr auto kOdd = factorial_ratios<5>();

/// The posterior mean between two states. Between them the most probable motion minimises ∫ (x''' + α x'')² dt, so
/// x'''''' = α² x'''', and x is a combination of 1, τ, τ², τ³ and the parts of cosh ατ and sinh ατ from the fourth and
/// fifth power on. With s = τ/Δt these are p_3 = s³, p_4 = s⁴ Σ 4!/(4 + 2n)! (α τ)^2n, p_5 = s⁵ Σ 5!/(5 + 2n)! (α
/// τ)^2n: all terms are positive, so nothing cancels.
struct Basis {
  double dt = 1.0;
  double square = 0.0;  ///< (α Δt)²
  int terms = 1;        ///< of the series
  /// Coefficients of (p_3, p_4, p_5) from what the motion lacks in (x, x', x'') at Δt.
  Matrix3 from_end = Matrix3::Zero();
  Basis() = default;
  Basis(double dt, double rate);
};

/// The weights of the mean at s = τ/Δt, or of its first or second derivative by time.
InterpolationWeights weights(const Basis& basis, double s, int derivative);

}  // namespace singer
}  // namespace evbench
