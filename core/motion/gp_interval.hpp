#pragma once

#include "core/geometry/se3.hpp"
#include "core/motion/motion_prior.hpp"
#include "core/motion/singer.hpp"

namespace evbench {

/// Increment of a control state, (pose, velocity) or (pose, velocity, acceleration): 12 or 18 rows.
using StateVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 18, 1>;
using StateMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 18, 18>;
/// Of two neighbouring control states: 24 or 36 rows.
using PairMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 36, 36>;

/// Pose, body velocity and, with Singer's prior, acceleration at a time: the state variable of a continuous-time
/// trajectory.
struct ControlState {
  double t = 0.0;                          ///< [s]
  SE3 T;                                   ///< T_world_camera
  Vector6 velocity = Vector6::Zero();      ///< ϖ = (ω, ν), body frame [rad/s, m/s]: Ṫ = T ϖ^
  Vector6 acceleration = Vector6::Zero();  ///< ϖ' [rad/s², m/s²]; zero where the motion prior has none

  /// T ← T Exp(δ_pose), ϖ ← ϖ + δ_velocity, ϖ' ← ϖ' + δ_acceleration for δ = (pose, velocity) or (pose, velocity,
  /// acceleration).
  ControlState retract(const StateVector& delta) const;
};

/// Log of the expected motion over dt [s]: dt ϖ, with Singer's prior and dt > 0 also that of the fading acceleration.
Vector6 expected_motion(const ControlState& state, double dt, const MotionPrior& prior = {});
/// ∂(that motion)/∂ϖ' [s²]; zero for WNOA and dt < 0.
double motion_per_acceleration(double dt, const MotionPrior& prior);
/// Variance of that motion by the prior alone, for Qc = 1 and dt ≥ 0 [s³].
double motion_variance(double dt, const MotionPrior& prior = {});
/// The expected state dt later; for dt < 0 that at constant velocity.
ControlState extrapolate(const ControlState& state, double dt, const MotionPrior& prior = {});

/// The GP between two neighbouring control states (0 and 1) under the motion prior.
///
/// With ξ_1 = Log(T_0⁻¹T_1), w_1 = J_r(ξ_1)⁻¹ϖ_1 and c_1 = d/dt(J_r(ξ)⁻¹ϖ) at the end, the posterior mean at τ = t −
/// t_0 in the tangent space of T_0 is linear in (ϖ_0, ξ_1, w_1), and with Singer's prior in (ϖ_0', c_1): T(t) = T_0
/// Exp(ξ(τ)), ϖ(t) = J_r(ξ) ξ'(τ) (Barfoot 2014, Dong 2018). For WNOA it is the cubic Hermite polynomial, because Qc
/// cancels; for Singer's see singer.hpp. Terms that depend only on the interval are computed once and shared by all
/// queries.
class GpInterval {
 public:
  GpInterval(const ControlState& state0, const ControlState& state1, const MotionPrior& prior = {});

  double t0() const { return t0_; }
  double dt() const { return dt_; }
  const SE3& T0() const { return T0_; }
  const Vector6& velocity0() const { return velocity0_; }
  const Vector6& xi1() const { return xi1_; }
  const Vector6& w1() const { return w1_; }
  const Vector6& acceleration0() const { return acceleration0_; }
  const Vector6& c1() const { return c1_; }
  const MotionPrior& prior() const { return prior_; }
  const singer::Basis& singer_basis() const { return basis_; }
  double singer_rate() const { return rate_; }  ///< that counts in this interval

  /// Of (ϖ_0, ξ_1, w_1, ϖ_0', c_1) in ξ(τ), and in its derivative by time.
  InterpolationWeights weights(double t) const;
  InterpolationWeights rate_weights(double t) const;
  Vector6 local(double t) const { return combine(weights(t)); }
  Vector6 local_rate(double t) const { return combine(rate_weights(t)); }

  SE3 pose(double t) const { return T0_ * se3::exp(local(t)); }
  Vector6 velocity(double t) const;

  /// Derivatives of (ξ_1, w_1, c_1) with respect to the increments of both states. ∂w_1/∂δT_i passes through ξ_1.
  struct Derivatives {
    Matrix6 xi1_T0;  ///< ∂ξ_1/∂δT_0 = −J_l(ξ_1)⁻¹
    Matrix6 xi1_T1;  ///< ∂ξ_1/∂δT_1 = J_r(ξ_1)⁻¹
    Matrix6 w1_T0;   ///< ∂w_1/∂δT_0
    Matrix6 w1_T1;   ///< ∂w_1/∂δT_1
    Matrix6 w1_v1;   ///< ∂w_1/∂δϖ_1 = J_r(ξ_1)⁻¹
    Matrix6 c1_T0 = Matrix6::Zero(), c1_T1 = c1_T0, c1_v1 = c1_T0, c1_a1 = c1_T0;  ///< zero for WNOA
  };
  Derivatives derivatives() const;

  /// Pose and velocity at t with their Jacobians with respect to both states' increments:
  /// rows (δT(t), δϖ(t)), columns δ of state 0 and of state 1.
  using Jacobian = Eigen::Matrix<double, 12, Eigen::Dynamic, Eigen::ColMajor, 12, 18>;
  struct Query {
    SE3 T;
    Vector6 velocity;
    Jacobian J0, J1;
  };
  Query query(double t, const Derivatives& derivatives) const;

  /// The residual of the motion prior between the two states, the end minus its expectation from the begin: WNOA: (ξ_1
  /// − Δt ϖ_0 ; w_1 − ϖ_0).
  StateVector prior_residual() const;

  /// The inverse of its covariance for Qc = 1, of one axis: 2 × 2 or 3 × 3.
  Eigen::MatrixXd prior_information_of_axis() const;

  /// ½ ‖residual‖² with its covariance.
  double prior_cost(const Vector6& qc) const;

  /// Its Jacobians with respect to the increments of state 0 and of state 1.
  struct PriorJacobians {
    StateMatrix J0, J1;
  };
  PriorJacobians prior_jacobians(const Derivatives& derivatives) const;

  /// Covariance of (δT(t), δϖ(t)) conditioned on both states (Barfoot 2014, eq. 24).
  Matrix12 conditional_covariance(double t, const Vector6& qc) const;

  /// Covariance of (δT(t), δϖ(t)): the joint covariance of both states' increments, propagated, plus the conditional
  /// covariance of the prior.
  Matrix12 covariance(double t, const PairMatrix& states, const Vector6& qc) const;

 private:
  Vector6 combine(const InterpolationWeights& h) const {
    Vector6 sum = h.velocity0 * velocity0_ + h.end * xi1_ + h.end_velocity * w1_;
    if (prior_.has_acceleration()) sum += h.acceleration0 * acceleration0_ + h.end_acceleration * c1_;
    return sum;
  }

  double t0_, dt_;
  MotionPrior prior_;
  double rate_ = 0.0;
  singer::Basis basis_;
  SE3 T0_;
  Vector6 velocity0_, velocity1_, xi1_, w1_;
  Vector6 acceleration0_ = Vector6::Zero(), acceleration1_ = acceleration0_, c1_ = acceleration0_;
  Matrix6 right_inverse_;  // J_r(ξ_1)⁻¹
};

}  // namespace evbench
