#pragma once

#include <array>
#include <cmath>

#include "backends/gp_map/engine/lanes.hpp"
#include "backends/gp_map/factors.hpp"
#include "core/geometry/lie_coefficients.hpp"

/// Sums of JᵀJ and Jᵀe over observations, kLanes landmarks at a time: the inner part of linearise_interval, which has
/// the derivation.
namespace evbench::gp_map::lanes {

inline constexpr int kPairs = 21;  ///< of a symmetric 6 × 6

/// b, c, and their derivatives with respect to z = θ².
struct Coefficients {
  Lane b, c, db, dc;
};

/// 1/(2n + 2)! and 1/(2n + 3)!, alternating: b and c as power series in z.
inline constexpr int kMaxTerms = 16;
struct Series {
  std::array<double, kMaxTerms> b{}, c{};
  constexpr Series() {
    double sign = 1.0, factorial = 1.0;  // (2n + 1)!
    for (std::size_t n = 0; n < kMaxTerms; ++n) {
      const double even = factorial * static_cast<double>(2 * n + 2);
      const double odd = even * static_cast<double>(2 * n + 3);
      b[n] = sign / even;
      c[n] = sign / odd;
      factorial = odd;
      sign = -sign;
    }
  }
};
inline constexpr Series kSeries;

template <int Terms>
Coefficients series(Lane z) {
  Coefficients r{};
  for (std::size_t n = Terms; n-- > 0;) {  // Horner, with derivatives
    r.db = r.db * z + r.b;
    r.dc = r.dc * z + r.c;
    r.b = r.b * z + kSeries.b[n];
    r.c = r.c * z + kSeries.c[n];
  }
  return r;
}

/// How the coefficients are computed for all observations of an interval: by the largest rotation angle in it.
enum class Range { small, medium, any };

template <Range range>
Coefficients coefficients(Lane z) {
  if constexpr (range == Range::small) return series<8>(z);    // θ < 1: 2e-16
  if constexpr (range == Range::medium) return series<16>(z);  // θ < 3.5
  Coefficients r{};
  for (int i = 0; i < kLanes; ++i) {
    const CoefficientJet b = coefficient_b(z[i]);
    const CoefficientJet c = coefficient_c(z[i]);
    r.b[i] = b.f;
    r.c[i] = c.f;
    r.db[i] = b.d;
    r.dc[i] = c.d;
  }
  return r;
}

inline Lane3 lane3(const Vector3& v) { return {broadcast(v.x()), broadcast(v.y()), broadcast(v.z())}; }

/// What all observations of the interval share.
struct Shared {
  const RobustLoss& loss;
  const PinholeCamera& camera;
  double t0, dt;
  Lane3 velocity_phi, velocity_rho, xi1_phi, xi1_rho, w1_phi, w1_rho;
};

/// The measured values of one observation of each lane's landmark.
struct Measured {
  Lane t{}, u{}, v{}, inverse_sigma{}, present{};
};

/// Sums over the interval, kept by lane and added up at the end.
struct IntervalSums {
  std::array<std::array<Lane, kPairs>, 6> yy{};  ///< (ϖ_0 ϖ_0), (ξ_1 ϖ_0), (ξ_1 ξ_1), (w_1 ϖ_0), (w_1 ξ_1), (w_1 w_1)
  std::array<Lane, 18> gradient_y{};
  std::array<Lane, kPairs> TT{};             ///< (δT_0, δT_0)
  std::array<std::array<Lane, 6>, 18> yT{};  ///< (y, δT_0)
  std::array<Lane, 6> gradient_T{};
  Lane cost{};
};

/// Sums over one landmark's observations in each lane.
struct LandmarkSums {
  std::array<std::array<Lane, 3>, 3> mm{};  ///< lower triangle
  std::array<Lane, 3> gradient{};
  std::array<std::array<Lane, 18>, 3> my{};
  Lane error{}, behind{};  ///< [px] of reprojection; how many have the landmark behind the camera
};

/// A row of the Jacobians of (m, ξ) for one component of the residual.
struct Row {
  std::array<Lane, 3> m;
  std::array<Lane, 6> xi;
};

struct Geometry {
  Lane3 phi, rho, u1, u2, q;
  Coefficients k;
  Lane s1;  // sin θ/θ
};

/// D: the row of the whitened projection's Jacobian with respect to q.
inline Row row(const Geometry& g, const Lane3& D) {
  const Coefficients& k = g.k;
  const Lane3 c1 = cross(g.phi, D);
  const Lane3 c2 = cross(g.phi, c1);
  const Lane3 d_m = D + g.s1 * c1 + k.b * c2;  // R D
  const Lane3 h = D + k.b * c1 + k.c * c2;     // J_l D = J_rᵀ D
  const Lane3 w = cross(D, g.q);
  const Lane3 w1 = cross(g.phi, w);
  const Lane3 w2 = cross(g.phi, w1);
  // d_mᵀ ∂(J_l(φ) ρ)/∂φ
  const Lane3 bend = k.b * cross(d_m, g.rho) + k.c * (cross(d_m, g.u1) + cross(cross(d_m, g.phi), g.rho));
  const Lane along = 2.0 * (k.db * dot(d_m, g.u1) + k.dc * dot(d_m, g.u2));
  const Lane3 left = w + k.b * w1 + k.c * w2 + bend - along * g.phi;
  return {{d_m.x, d_m.y, d_m.z}, {left.x, left.y, left.z, -h.x, -h.y, -h.z}};
}

/// Adds one observation of each lane, JᵀJ and Jᵀe by blocks.
inline void accumulate(const std::array<Row, 2>& rows, const std::array<Lane, 3>& basis, const std::array<Lane, 2>& e,
                       Lane weight, LandmarkSums& landmark, IntervalSums& sums) {
  std::array<Lane, 6> Ge;
  std::array<std::array<Lane, 6>, 2> wG;
  for (std::size_t i = 0; i < 6; ++i) {
    wG[0][i] = weight * rows[0].xi[i];
    wG[1][i] = weight * rows[1].xi[i];
    Ge[i] = wG[0][i] * e[0] + wG[1][i] * e[1];
  }
  const std::array<Lane, 6> products = {basis[0] * basis[0], basis[1] * basis[0], basis[1] * basis[1],
                                        basis[2] * basis[0], basis[2] * basis[1], basis[2] * basis[2]};
  std::size_t n = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t j = 0; j <= i; ++j, ++n) {
      const Lane GG = wG[0][i] * rows[0].xi[j] + wG[1][i] * rows[1].xi[j];
      for (std::size_t p = 0; p < 6; ++p) sums.yy[p][n] += products[p] * GG;
    }
    for (std::size_t p = 0; p < 3; ++p) sums.gradient_y[6 * p + i] += basis[p] * Ge[i];
  }
  for (std::size_t r = 0; r < 3; ++r) {
    const Lane m0 = weight * rows[0].m[r];
    const Lane m1 = weight * rows[1].m[r];
    landmark.gradient[r] += m0 * e[0] + m1 * e[1];
    for (std::size_t c = 0; c <= r; ++c) landmark.mm[r][c] += m0 * rows[0].m[c] + m1 * rows[1].m[c];
    for (std::size_t i = 0; i < 6; ++i) {
      const Lane BG = rows[0].m[r] * wG[0][i] + rows[1].m[r] * wG[1][i];
      for (std::size_t p = 0; p < 3; ++p) landmark.my[r][6 * p + i] += basis[p] * BG;
    }
  }
}

/// Adds an observation of the landmark m = T_0⁻¹ l of each lane.
template <Range range>
void add_observation(const Shared& shared, const Lane3& m, const Measured& z, LandmarkSums& landmark,
                     IntervalSums& sums) {
  const Lane s = (z.t - shared.t0) / shared.dt;
  const Lane rest = 1.0 - s;
  const std::array<Lane, 3> basis = {shared.dt * s * rest * rest, s * s * (3.0 - 2.0 * s), -shared.dt * s * s * rest};
  Geometry g;
  g.phi = basis[0] * shared.velocity_phi + basis[1] * shared.xi1_phi + basis[2] * shared.w1_phi;
  g.rho = basis[0] * shared.velocity_rho + basis[1] * shared.xi1_rho + basis[2] * shared.w1_rho;
  const Lane theta2 = dot(g.phi, g.phi);
  g.k = coefficients<range>(theta2);
  g.s1 = 1.0 - theta2 * g.k.c;
  g.u1 = cross(g.phi, g.rho);
  g.u2 = cross(g.phi, g.u1);
  const Lane3 d = m - (g.rho + g.k.b * g.u1 + g.k.c * g.u2);
  const Lane3 d1 = cross(g.phi, d);
  g.q = d - g.s1 * d1 + g.k.b * cross(g.phi, d1);

  const auto in_front = g.q.z > 0.0;
  const Lane iz = 1.0 / (in_front ? g.q.z : Lane{} + 1.0);
  const Lane x = g.q.x * iz;
  const Lane y = g.q.y * iz;
  const Lane behind = 2.0 * shared.camera.fx * z.inverse_sigma;
  const Lane e0 = in_front ? z.inverse_sigma * (shared.camera.fx * x + shared.camera.cx - z.u) : behind;
  const Lane e1 = in_front ? z.inverse_sigma * (shared.camera.fy * y + shared.camera.cy - z.v) : behind;
  const Lane square = e0 * e0 + e1 * e1;
  Lane error{};
  for (int i = 0; i < kLanes; ++i) error[i] = std::sqrt(square[i]);
  landmark.error += (z.present > 0.0) & in_front ? error / z.inverse_sigma : Lane{};
  landmark.behind += in_front ? Lane{} : z.present;
  Lane weight = z.present;
  for (int i = 0; i < kLanes; ++i) {
    sums.cost[i] += 0.5 * z.present[i] * shared.loss.value(square[i]);
    weight[i] *= shared.loss.weight(square[i]);
  }
  weight = in_front ? weight : Lane{};
  const Lane ax = shared.camera.fx * z.inverse_sigma * iz;
  const Lane ay = shared.camera.fy * z.inverse_sigma * iz;
  const std::array<Row, 2> rows = {row(g, {ax, Lane{}, -ax * x}), row(g, {Lane{}, ay, -ay * y})};

  accumulate(rows, basis, {e0, e1}, weight, landmark, sums);
}

}  // namespace evbench::gp_map::lanes
