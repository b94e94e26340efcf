#pragma once

#include "core/geometry/se3.hpp"

namespace evbench {

/// Pose and body velocity at a time: the state variable of a continuous-time trajectory.
struct ControlState {
  double t = 0.0;                      ///< [s]
  SE3 T;                               ///< T_world_camera
  Vector6 velocity = Vector6::Zero();  ///< ϖ = (ω, ν), body frame [rad/s, m/s]: Ṫ = T ϖ^

  /// T ← T Exp(δ_pose), ϖ ← ϖ + δ_velocity for δ = (pose, velocity).
  ControlState retract(const Vector12& delta) const {
    return {t, T * se3::exp(delta.head<6>()), velocity + delta.tail<6>()};
  }
};

/// The state dt [s] later (or earlier) at constant body velocity: T Exp(dt ϖ).
ControlState extrapolate(const ControlState& state, double dt);

/// Weights of (ϖ_0, ξ_1, J_r(ξ_1)⁻¹ϖ_1) in the local tangent ξ(τ) and in its time derivative.
struct HermiteWeights {
  double a, b, c;     ///< ξ(τ) = a ϖ_0 + b ξ_1 + c w_1
  double da, db, dc;  ///< ξ'(τ) = da ϖ_0 + db ξ_1 + dc w_1
  HermiteWeights(double s, double dt);
};

/// The GP between two neighbouring control states (0 and 1) under the WNOA prior.
///
/// With ξ_1 = Log(T_0⁻¹T_1) and w_1 = J_r(ξ_1)⁻¹ϖ_1, the posterior mean at τ = t − t_0, s = τ/Δt, is the cubic Hermite
/// polynomial ξ(τ) in the tangent space of T_0, and T(t) = T_0 Exp(ξ(τ)), ϖ(t) = J_r(ξ) ξ'(τ) (Dong 2018; Λ and Ψ
/// reduce to it because Qc cancels). Terms that depend only on the interval are computed once and shared by all
/// queries.
class GpInterval {
 public:
  GpInterval(const ControlState& state0, const ControlState& state1);

  double t0() const { return t0_; }
  double dt() const { return dt_; }
  const SE3& T0() const { return T0_; }
  const Vector6& velocity0() const { return velocity0_; }
  const Vector6& xi1() const { return xi1_; }
  const Vector6& w1() const { return w1_; }

  HermiteWeights weights(double t) const { return {(t - t0_) / dt_, dt_}; }
  Vector6 local(const HermiteWeights& h) const { return h.a * velocity0_ + h.b * xi1_ + h.c * w1_; }
  Vector6 local_rate(const HermiteWeights& h) const { return h.da * velocity0_ + h.db * xi1_ + h.dc * w1_; }

  SE3 pose(double t) const { return T0_ * se3::exp(local(weights(t))); }
  Vector6 velocity(double t) const;

  /// Derivatives of (ξ_1, w_1) with respect to the increments of both states. ∂w_1/∂δT_i passes through ξ_1.
  struct Derivatives {
    Matrix6 xi1_T0;  ///< ∂ξ_1/∂δT_0 = −J_l(ξ_1)⁻¹
    Matrix6 xi1_T1;  ///< ∂ξ_1/∂δT_1 = J_r(ξ_1)⁻¹
    Matrix6 w1_T0;   ///< ∂w_1/∂δT_0
    Matrix6 w1_T1;   ///< ∂w_1/∂δT_1
    Matrix6 w1_v1;   ///< ∂w_1/∂δϖ_1 = J_r(ξ_1)⁻¹
  };
  Derivatives derivatives() const;

  /// Pose and velocity at t with their Jacobians with respect to both states' increments (pose, velocity):
  /// rows (δT(t), δϖ(t)), columns δ of state 0 and of state 1.
  struct Query {
    SE3 T;
    Vector6 velocity;
    Matrix12 J0, J1;
  };
  Query query(double t, const Derivatives& derivatives) const;

  /// The residual of the WNOA prior between the two states: (ξ_1 − Δt ϖ_0 ; w_1 − ϖ_0).
  Vector12 prior_residual() const;

  /// Its Jacobians with respect to the increments of state 0 and of state 1.
  struct PriorJacobians {
    Matrix12 J0, J1;
  };
  PriorJacobians prior_jacobians(const Derivatives& derivatives) const;

  /// Covariance of (δT(t), δϖ(t)) conditioned on both states (Barfoot 2014, eq. 24).
  Matrix12 conditional_covariance(double t, const Vector6& qc) const;

  /// Covariance of (δT(t), δϖ(t)): the joint covariance of both states' increments (24 × 24), propagated, plus the
  /// conditional covariance of the prior.
  Matrix12 covariance(double t, const Eigen::Matrix<double, 24, 24>& states, const Vector6& qc) const;

 private:
  double t0_, dt_;
  SE3 T0_;
  Vector6 velocity0_, velocity1_, xi1_, w1_;
  Matrix6 right_inverse_;  // J_r(ξ_1)⁻¹
};

}  // namespace evbench
