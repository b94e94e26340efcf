#include "core/motion/gp_interval.hpp"

#include <Eigen/Cholesky>

#include "core/motion/wnoa.hpp"

namespace evbench {

ControlState extrapolate(const ControlState& state, double dt) {
  return {state.t + dt, state.T * se3::exp(dt * state.velocity), state.velocity};
}

HermiteWeights::HermiteWeights(double s, double dt)
    : a(dt * s * (1.0 - s) * (1.0 - s)),
      b(s * s * (3.0 - 2.0 * s)),
      c(-dt * s * s * (1.0 - s)),
      da((1.0 - s) * (1.0 - 3.0 * s)),
      db(6.0 * s * (1.0 - s) / dt),
      dc(s * (3.0 * s - 2.0)) {}

GpInterval::GpInterval(const ControlState& state0, const ControlState& state1)
    : t0_(state0.t),
      dt_(state1.t - state0.t),
      T0_(state0.T),
      velocity0_(state0.velocity),
      velocity1_(state1.velocity),
      xi1_(se3::log(state0.T.inverse() * state1.T)),
      right_inverse_(se3::right_jacobian_inverse(xi1_)) {
  w1_ = right_inverse_ * velocity1_;
}

Vector6 GpInterval::velocity(double t) const {
  const HermiteWeights h = weights(t);
  return se3::right_jacobian(local(h)) * local_rate(h);
}

GpInterval::Derivatives GpInterval::derivatives() const {
  const Matrix6 dw_dxi = se3::d_right_jacobian_inverse(xi1_, velocity1_);
  Derivatives d;
  d.xi1_T0 = -se3::left_jacobian_inverse(xi1_);
  d.xi1_T1 = right_inverse_;
  d.w1_T0 = dw_dxi * d.xi1_T0;
  d.w1_T1 = dw_dxi * d.xi1_T1;
  d.w1_v1 = right_inverse_;
  return d;
}

GpInterval::Query GpInterval::query(double t, const Derivatives& d) const {
  const HermiteWeights h = weights(t);
  const Vector6 xi = local(h);
  const Vector6 rate = local_rate(h);
  const SE3 step = se3::exp(xi);
  const Matrix6 jr = se3::right_jacobian(xi);
  const Matrix6 bend = se3::d_right_jacobian(xi, rate);  // ∂(J_r(ξ)ξ')/∂ξ
  const Matrix6 xi_T0 = h.b * d.xi1_T0 + h.c * d.w1_T0;
  const Matrix6 xi_T1 = h.b * d.xi1_T1 + h.c * d.w1_T1;
  Query q;
  q.T = T0_ * step;
  q.velocity = jr * rate;
  q.J0 << se3::adjoint(step.inverse()) + jr * xi_T0, h.a * jr, bend * xi_T0 + jr * (h.db * d.xi1_T0 + h.dc * d.w1_T0),
      h.a * bend + h.da * jr;
  q.J1 << jr * xi_T1, h.c * jr * d.w1_v1, bend * xi_T1 + jr * (h.db * d.xi1_T1 + h.dc * d.w1_T1),
      (h.c * bend + h.dc * jr) * d.w1_v1;
  return q;
}

Vector12 GpInterval::prior_residual() const {
  Vector12 e;
  e << xi1_ - dt_ * velocity0_, w1_ - velocity0_;
  return e;
}

GpInterval::PriorJacobians GpInterval::prior_jacobians(const Derivatives& d) const {
  PriorJacobians j;
  j.J0 << d.xi1_T0, -dt_ * Matrix6::Identity(), d.w1_T0, -Matrix6::Identity();
  j.J1 << d.xi1_T1, Matrix6::Zero(), d.w1_T1, d.w1_v1;
  return j;
}

Matrix12 GpInterval::conditional_covariance(double t, const Vector6& qc) const {
  const double tau = t - t0_;
  if (tau <= 0.0 || tau >= dt_) return Matrix12::Zero();
  const Matrix12 phi = wnoa::transition(dt_ - tau);
  const Matrix12 information =
      wnoa::process_information(tau, qc) + phi.transpose() * wnoa::process_information(dt_ - tau, qc) * phi;
  const Matrix12 local_covariance = information.llt().solve(Matrix12::Identity());
  const HermiteWeights h = weights(t);
  const Vector6 xi = local(h);
  Matrix12 map = Matrix12::Zero();  // local (ξ, ξ') → (δT, δϖ)
  map.topLeftCorner<6, 6>() = se3::right_jacobian(xi);
  map.bottomLeftCorner<6, 6>() = se3::d_right_jacobian(xi, local_rate(h));
  map.bottomRightCorner<6, 6>() = map.topLeftCorner<6, 6>();
  return map * local_covariance * map.transpose();
}

Matrix12 GpInterval::covariance(double t, const Eigen::Matrix<double, 24, 24>& states, const Vector6& qc) const {
  const Query q = query(t, derivatives());
  Eigen::Matrix<double, 12, 24> J;
  J << q.J0, q.J1;
  return J * states * J.transpose() + conditional_covariance(t, qc);
}

}  // namespace evbench
