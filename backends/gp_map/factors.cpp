#include "backends/gp_map/factors.hpp"

#include <array>
#include <cmath>

#include "core/geometry/lie_coefficients.hpp"
#include "core/geometry/so3.hpp"
#include "core/motion/wnoa.hpp"

namespace evbench::gp_map {
namespace {

using Matrix18 = Eigen::Matrix<double, 18, 18>;
using Vector18 = Eigen::Matrix<double, 18, 1>;
using Matrix3x6 = Eigen::Matrix<double, 3, 6>;
using Matrix3x18 = Eigen::Matrix<double, 3, 18>;
using Matrix6x24 = Eigen::Matrix<double, 6, 24>;

/// An observation seen from the interval's first pose: with m = T_0⁻¹ l and ξ = ξ(τ) the residual is a function of
/// (m, ξ) alone, e = whitened π(Exp(−ξ) m) − z.
struct LocalObservation {
  Vector2 e;
  Matrix23 d_m;   ///< ∂e/∂m
  Matrix26 d_xi;  ///< ∂e/∂ξ
  bool in_front;
};

LocalObservation local_observation(const Vector3& m, const Vector6& xi, const Observation& z,
                                   const PinholeCamera& camera) {
  const Vector3 phi = xi.head<3>();
  const Vector3 rho = xi.tail<3>();
  const double theta2 = phi.squaredNorm();
  const CoefficientJet b = coefficient_b(theta2);
  const CoefficientJet c = coefficient_c(theta2);
  const Matrix3 K = so3::hat(phi);
  const Matrix3 K2 = K * K;
  const Matrix3 Rt = Matrix3::Identity() - (1.0 - theta2 * c.f) * K + b.f * K2;  // exp(−φ); sin θ/θ = 1 − θ² c
  const Vector3 u1 = phi.cross(rho);
  const Vector3 u2 = phi.cross(u1);
  const Vector3 p = rho + b.f * u1 + c.f * u2;  // J_l(φ) ρ
  const Vector3 q = Rt * (m - p);
  LocalObservation o;
  o.in_front = q.z() > 0.0;
  if (!o.in_front) {
    o.e.setConstant(2.0 * camera.fx * z.inverse_sigma);
    return o;
  }
  o.e = z.inverse_sigma * (camera.project(q) - z.pixel);
  const Matrix23 D = z.inverse_sigma * camera.project_jacobian(q);
  o.d_m = D * Rt;
  const Matrix3 Jr = Matrix3::Identity() - b.f * K + c.f * K2;
  // ∂(J_l(φ) ρ)/∂φ
  const Matrix3 d_p =
      -b.f * so3::hat(rho) - c.f * (so3::hat(u1) + K * so3::hat(rho)) + 2.0 * (b.d * u1 + c.d * u2) * phi.transpose();
  o.d_xi.leftCols<3>() = D * so3::hat(q) * Jr - o.d_m * d_p;
  o.d_xi.rightCols<3>() = -D * Jr;
  return o;
}

/// Normal equations in the local coordinates (δT_0, δϖ_0, δξ_1, δw_1).
struct LocalSystem {
  Matrix24 H = Matrix24::Zero();
  Vector24 g = Vector24::Zero();
  double cost = 0.0;
};

/// Adds a landmark's observations in the interval; returns its coupling to the local coordinates.
/// ξ = a ϖ_0 + b ξ_1 + c w_1, so that with G = ∂e/∂ξ the block of each pair of these three is a multiple of GᵀG, and
/// the first pose acts through m alone: δm = R_0ᵀ δl + [m^, −I] δT_0.
IntervalLinearisation::Coupling add_group(const FactorGraph& graph, const GpInterval& interval, const Matrix3& R0,
                                          const IntervalObservations& observations,
                                          const IntervalObservations::Group& group, LocalSystem& system) {
  const Vector3 m =
      R0.transpose() * (graph.landmarks[static_cast<std::size_t>(group.landmark)].position - interval.T0().p);
  Matrix3 H_mm = Matrix3::Zero();
  Vector3 g_m = Vector3::Zero();
  Matrix3x18 H_my = Matrix3x18::Zero();
  for (int i = group.begin; i < group.end; ++i) {
    const Observation& z = observations.all()[static_cast<std::size_t>(i)];
    const HermiteWeights h = interval.weights(z.t);
    const LocalObservation o = local_observation(m, interval.local(h), z, graph.camera);
    const double s = o.e.squaredNorm();
    system.cost += 0.5 * graph.loss.value(s);
    if (!o.in_front) continue;
    const double weight = graph.loss.weight(s);
    const std::array<double, 3> basis = {h.a, h.b, h.c};
    const Matrix26 wG = weight * o.d_xi;
    const Matrix6 GG = o.d_xi.transpose() * wG;
    const Vector6 Ge = wG.transpose() * o.e;
    const Matrix3x6 BG = o.d_m.transpose() * wG;
    H_mm.noalias() += weight * o.d_m.transpose() * o.d_m;
    g_m.noalias() += weight * o.d_m.transpose() * o.e;
    for (int row = 0; row < 3; ++row) {
      const double scale = basis[static_cast<std::size_t>(row)];
      H_my.middleCols<6>(6 * row) += scale * BG;
      system.g.segment<6>(6 + 6 * row) += scale * Ge;
      for (int column = 0; column <= row; ++column) {
        system.H.block<6, 6>(6 + 6 * row, 6 + 6 * column) += (scale * basis[static_cast<std::size_t>(column)]) * GG;
      }
    }
  }
  Matrix3x6 M;
  M << so3::hat(m), -Matrix3::Identity();
  const Matrix3x6 H_mM = H_mm * M;
  system.H.topLeftCorner<6, 6>().noalias() += M.transpose() * H_mM;
  system.H.bottomLeftCorner<18, 6>().noalias() += H_my.transpose() * M;
  system.g.head<6>().noalias() += M.transpose() * g_m;

  IntervalLinearisation::Coupling coupling;
  coupling.landmark = group.landmark;
  coupling.landmark_states.leftCols<6>() = R0 * H_mM;
  coupling.landmark_states.rightCols<18>() = R0 * H_my;
  coupling.landmark_landmark = R0 * H_mm * R0.transpose();
  coupling.gradient = R0 * g_m;
  return coupling;
}

/// The residual (ξ_1 − Δt ϖ_0 ; w_1 − ϖ_0) is linear in the local coordinates.
void add_motion_prior(const GpInterval& interval, const Vector6& qc, LocalSystem& system) {
  const Matrix12 W = wnoa::process_information(interval.dt(), qc);
  Eigen::Matrix<double, 12, 24> J = Eigen::Matrix<double, 12, 24>::Zero();
  J.block<6, 6>(0, 6).diagonal().setConstant(-interval.dt());
  J.block<6, 6>(6, 6).diagonal().setConstant(-1.0);
  J.block<12, 12>(0, 12).setIdentity();
  const Vector12 e = interval.prior_residual();
  const Eigen::Matrix<double, 12, 24> WJ = W * J;
  system.H.noalias() += J.transpose() * WJ;
  system.g.noalias() += WJ.transpose() * e;
  system.cost += 0.5 * e.dot(W * e);
}

/// ∂(ξ_1, w_1)/∂(increments of both states), 12 × 24.
Eigen::Matrix<double, 12, 24> end_map(const GpInterval::Derivatives& d) {
  Eigen::Matrix<double, 12, 24> map = Eigen::Matrix<double, 12, 24>::Zero();
  map.block<6, 6>(0, 0) = d.xi1_T0;
  map.block<6, 6>(0, 12) = d.xi1_T1;
  map.block<6, 6>(6, 0) = d.w1_T0;
  map.block<6, 6>(6, 12) = d.w1_T1;
  map.block<6, 6>(6, 18) = d.w1_v1;
  return map;
}

}  // namespace

Vector2 reprojection_residual(const GpInterval& interval, const Vector3& landmark, const Observation& z,
                              const PinholeCamera& camera) {
  const Vector3 q = interval.pose(z.t).inverse() * landmark;
  if (!(q.z() > 0.0)) return Vector2::Constant(2.0 * camera.fx * z.inverse_sigma);
  return z.inverse_sigma * (camera.project(q) - z.pixel);
}

double motion_prior_cost(const GpInterval& interval, const Vector6& qc) {
  const Vector12 e = interval.prior_residual();
  return 0.5 * e.dot(wnoa::process_information(interval.dt(), qc) * e);
}

Vector6 residual(const PosePrior& prior, const ControlState& state) {
  return se3::log(prior.T.inverse() * state.T).cwiseQuotient(prior.sigma);
}

Vector6 residual(const VelocityPrior& prior, const ControlState& state) {
  return (state.velocity - prior.velocity).cwiseQuotient(prior.sigma);
}

Vector3 residual(const LandmarkPrior& prior, const Vector3& position) {
  if (!std::isfinite(prior.sigma)) return Vector3::Zero();
  return (position - prior.position) / prior.sigma;
}

void linearise_interval(const FactorGraph& graph, int k, IntervalLinearisation& result) {
  const auto index = static_cast<std::size_t>(k);
  const GpInterval interval(graph.states[index - 1], graph.states[index]);
  const IntervalObservations& observations = graph.intervals[index];
  const Matrix3 R0 = interval.T0().R();
  LocalSystem system;
  result.couplings.clear();
  result.couplings.reserve(observations.groups().size());
  for (const auto& group : observations.groups()) {
    result.couplings.push_back(add_group(graph, interval, R0, observations, group, system));
  }
  add_motion_prior(interval, graph.qc, system);
  system.H = Matrix24(system.H.selfadjointView<Eigen::Lower>());

  // From the local coordinates to the increments of both states: the first 12 stay, (ξ_1, w_1) are mapped.
  const Eigen::Matrix<double, 12, 24> map = end_map(interval.derivatives());
  const Eigen::Matrix<double, 12, 24> end_rows = system.H.bottomRows<12>();
  const Matrix12 H11 = end_rows.rightCols<12>();
  Eigen::Matrix<double, 12, 24> cross = Eigen::Matrix<double, 12, 24>::Zero();
  cross.leftCols<12>() = end_rows.leftCols<12>();
  const Matrix24 mixed = map.transpose() * cross;
  result.states = mixed + mixed.transpose() + map.transpose() * (H11 * map);
  result.states.topLeftCorner<12, 12>() += system.H.topLeftCorner<12, 12>();
  result.gradient = map.transpose() * system.g.tail<12>();
  result.gradient.head<12>() += system.g.head<12>();
  result.cost = system.cost;
  for (auto& coupling : result.couplings) {
    const Eigen::Matrix<double, 3, 12> start = coupling.landmark_states.leftCols<12>();
    const Eigen::Matrix<double, 3, 12> end = coupling.landmark_states.rightCols<12>();
    coupling.landmark_states.noalias() = end * map;
    coupling.landmark_states.leftCols<12>() += start;
  }
}

void add_state_priors(const FactorGraph& graph, int state, Matrix12& H, Vector12& g) {
  const ControlState& x = graph.states[static_cast<std::size_t>(state)];
  for (const PosePrior& prior : graph.pose_priors) {
    if (prior.state != state) continue;
    const Vector6 whiten = prior.sigma.cwiseInverse();
    const Matrix6 J = whiten.asDiagonal() * se3::right_jacobian_inverse(se3::log(prior.T.inverse() * x.T));
    H.topLeftCorner<6, 6>() += J.transpose() * J;
    g.head<6>() += J.transpose() * residual(prior, x);
  }
  for (const VelocityPrior& prior : graph.velocity_priors) {
    if (prior.state != state) continue;
    const Vector6 whiten = prior.sigma.cwiseInverse();
    H.bottomRightCorner<6, 6>().diagonal() += whiten.cwiseAbs2();
    g.tail<6>() += whiten.cwiseProduct(residual(prior, x));
  }
}

double mean_log_distance(const FactorGraph& graph) {
  if (graph.anchor.landmarks.empty()) return 0.0;
  double sum = 0.0;
  for (const int j : graph.anchor.landmarks) {
    sum += std::log((graph.landmarks[static_cast<std::size_t>(j)].position - graph.anchor.origin).norm());
  }
  return sum / static_cast<double>(graph.anchor.landmarks.size());
}

AnchorLinearisation linearise_anchor(const FactorGraph& graph) {
  AnchorLinearisation result;
  const ScaleAnchor& anchor = graph.anchor;
  result.e = (mean_log_distance(graph) - anchor.mean_log_distance) / anchor.sigma;
  const double share = 1.0 / (anchor.sigma * static_cast<double>(anchor.landmarks.size()));
  for (const int j : anchor.landmarks) {
    const Vector3 from_origin = graph.landmarks[static_cast<std::size_t>(j)].position - anchor.origin;
    result.jacobian.push_back(share * from_origin / from_origin.squaredNorm());
  }
  return result;
}

}  // namespace evbench::gp_map
