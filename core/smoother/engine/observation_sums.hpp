#pragma once

#include "core/smoother/engine/lane_loss.hpp"
#include "core/smoother/engine/observation_geometry.hpp"

/// Sums of JᵀJ and Jᵀe over observations, kLanes landmarks at a time: the inner loop of linearise_interval(), which
/// documents the derivation.
namespace evbench::smoother::lanes {

inline constexpr int kPairs = 21;  ///< of a symmetric 6 × 6

/// The data that all observations of the interval share.
template <int Orders>
struct Shared {
  const RobustLoss& loss;
  const PinholeCamera& camera;
  Interval<Orders> interval;
};

/// Sums over the interval, by lane; the lanes are added up at the end. y = (ϖ_0, ξ_1, w_1, ...), the vectors of
/// Interval.
template <int Orders>
struct IntervalSums {
  static constexpr std::size_t kTerms = Interval<Orders>::kTerms, kRows = 6 * kTerms;
  /// (y_0 y_0), (y_1 y_0), (y_1 y_1), (y_2 y_0), ...
  std::array<std::array<Lane, kPairs>, kTerms*(kTerms + 1) / 2> yy{};
  std::array<Lane, kRows> gradient_y{};
  std::array<Lane, kPairs> TT{};                ///< (δT_0, δT_0)
  std::array<std::array<Lane, 6>, kRows> yT{};  ///< (y, δT_0)
  std::array<Lane, 6> gradient_T{};
  Lane cost{};
};

/// Sums over one landmark's observations in each lane.
template <int Orders>
struct LandmarkSums {
  std::array<std::array<Lane, 3>, 3> mm{};  ///< lower triangle
  std::array<Lane, 3> gradient{};
  std::array<std::array<Lane, IntervalSums<Orders>::kRows>, 3> my{};
  Lane error{},
      behind{};  ///< [px] sum of reprojection errors; number of observations with the landmark behind the camera
};

/// A row of the Jacobians of (m, ξ) for one component of the residual.
struct Row {
  std::array<Lane, 3> m;
  std::array<Lane, 6> xi;
};

/// D: the row of the whitened projection's Jacobian with respect to q.
inline Row row(const Tangent& g, const Lane3& q, const Lane3& D) {
  const Coefficients& k = g.k;
  const Lane3 c1 = cross(g.phi, D);
  const Lane3 c2 = cross(g.phi, c1);
  const Lane3 d_m = D + g.s1 * c1 + k.b * c2;  // R D
  const Lane3 h = D + k.b * c1 + k.c * c2;     // J_l D = J_rᵀ D
  const Lane3 w = cross(D, q);
  const Lane3 w1 = cross(g.phi, w);
  const Lane3 w2 = cross(g.phi, w1);
  // d_mᵀ ∂(J_l(φ) ρ)/∂φ
  const Lane3 bend = k.b * cross(d_m, g.rho) + k.c * (cross(d_m, g.u1) + cross(cross(d_m, g.phi), g.rho));
  const Lane along = 2.0 * (k.db * dot(d_m, g.u1) + k.dc * dot(d_m, g.u2));
  const Lane3 left = w + k.b * w1 + k.c * w2 + bend - along * g.phi;
  return {{d_m.x, d_m.y, d_m.z}, {left.x, left.y, left.z, -h.x, -h.y, -h.z}};
}

/// Adds JᵀJ and Jᵀe of one observation per lane, by blocks.
template <int Orders>
void accumulate(const std::array<Row, 2>& rows, const Basis<Orders>& basis, const std::array<Lane, 2>& e, Lane weight,
                LandmarkSums<Orders>& landmark, IntervalSums<Orders>& sums) {
  constexpr std::size_t kTerms = Interval<Orders>::kTerms;
  std::array<Lane, 6> Ge;
  std::array<std::array<Lane, 6>, 2> wG;
  for (std::size_t i = 0; i < 6; ++i) {
    wG[0][i] = weight * rows[0].xi[i];
    wG[1][i] = weight * rows[1].xi[i];
    Ge[i] = wG[0][i] * e[0] + wG[1][i] * e[1];
  }
  std::array<Lane, kTerms*(kTerms + 1) / 2> products;
  for (std::size_t p = 0, pair = 0; p < kTerms; ++p) {
    for (std::size_t q = 0; q <= p; ++q, ++pair) products[pair] = basis[p] * basis[q];
  }
  std::size_t n = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t j = 0; j <= i; ++j, ++n) {
      const Lane GG = wG[0][i] * rows[0].xi[j] + wG[1][i] * rows[1].xi[j];
      for (std::size_t p = 0; p < products.size(); ++p) sums.yy[p][n] += products[p] * GG;
    }
    for (std::size_t p = 0; p < kTerms; ++p) sums.gradient_y[6 * p + i] += basis[p] * Ge[i];
  }
  for (std::size_t r = 0; r < 3; ++r) {
    const Lane m0 = weight * rows[0].m[r];
    const Lane m1 = weight * rows[1].m[r];
    landmark.gradient[r] += m0 * e[0] + m1 * e[1];
    for (std::size_t c = 0; c <= r; ++c) landmark.mm[r][c] += m0 * rows[0].m[c] + m1 * rows[1].m[c];
    for (std::size_t i = 0; i < 6; ++i) {
      const Lane BG = rows[0].m[r] * wG[0][i] + rows[1].m[r] * wG[1][i];
      for (std::size_t p = 0; p < kTerms; ++p) landmark.my[r][6 * p + i] += basis[p] * BG;
    }
  }
}

/// Adds one observation of the landmark m = T_0⁻¹ l of each lane.
template <Range range, int Orders>
void add_observation(const Shared<Orders>& shared, const Lane3& m, const Measured& z, LandmarkSums<Orders>& landmark,
                     IntervalSums<Orders>& sums) {
  const Basis<Orders> basis = basis_at(shared.interval, z.t);
  const Tangent g = tangent<range, Orders>(shared.interval, basis);
  const Lane3 q = motion(g).into_camera(m);
  const Residual residual = residual_of(shared.camera, q, z);
  const LaneLoss loss = loss_of(shared.loss, residual.square);
  landmark.error += (z.present > 0.0) & residual.in_front ? residual.px() : Lane{};
  landmark.behind += residual.in_front ? Lane{} : z.present;
  sums.cost += 0.5 * z.present * loss.value;
  const Lane weight = residual.in_front ? z.present * loss.weight : Lane{};
  const ImageRows D = image_rows(shared.camera, residual, z);
  accumulate<Orders>({row(g, q, D.x), row(g, q, D.y)}, basis, {residual.e0, residual.e1}, weight, landmark, sums);
}

}  // namespace evbench::smoother::lanes
