#include "core/motion/gp_interval.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "core/motion/wnoa.hpp"

namespace evbench {

ControlState ControlState::retract(const StateVector& delta) const {
  ControlState result{t, T * se3::exp(delta.head<6>()), velocity + delta.segment<6>(6), acceleration};
  if (delta.size() == 18) result.acceleration += delta.tail<6>();
  return result;
}

double motion_per_acceleration(double dt, const MotionPrior& prior) {
  if (!prior.has_acceleration() || dt <= 0.0) return 0.0;
  return singer::transition(dt, singer::rate_within(prior.rate, dt))(0, 2);
}

Vector6 expected_motion(const ControlState& state, double dt, const MotionPrior& prior) {
  Vector6 xi = dt * state.velocity;
  if (prior.has_acceleration()) xi += motion_per_acceleration(dt, prior) * state.acceleration;
  return xi;
}

double motion_variance(double dt, const MotionPrior& prior) {
  if (prior.has_acceleration()) return singer::process_covariance(dt, singer::rate_within(prior.rate, dt))(0, 0);
  return wnoa::process_covariance(dt, Vector6::Ones())(0, 0);
}

ControlState extrapolate(const ControlState& state, double dt, const MotionPrior& prior) {
  const Vector6 xi = expected_motion(state, dt, prior);
  ControlState result{state.t + dt, state.T * se3::exp(xi), state.velocity, state.acceleration};
  if (!prior.has_acceleration() || dt <= 0.0) return result;
  const Matrix3 phi = singer::transition(dt, singer::rate_within(prior.rate, dt));
  result.velocity = se3::right_jacobian(xi) * (state.velocity + phi(1, 2) * state.acceleration);
  result.acceleration *= phi(2, 2);
  return result;
}

GpInterval::GpInterval(const ControlState& state0, const ControlState& state1, const MotionPrior& prior)
    : t0_(state0.t),
      dt_(state1.t - state0.t),
      prior_(prior),
      T0_(state0.T),
      velocity0_(state0.velocity),
      velocity1_(state1.velocity),
      xi1_(se3::log(state0.T.inverse() * state1.T)),
      right_inverse_(se3::right_jacobian_inverse(xi1_)) {
  w1_ = right_inverse_ * velocity1_;
  if (!prior_.has_acceleration()) return;
  rate_ = singer::rate_within(prior_.rate, dt_);
  basis_ = singer::Basis(dt_, rate_);
  acceleration0_ = state0.acceleration;
  acceleration1_ = state1.acceleration;
  c1_ = right_inverse_ * acceleration1_ + se3::d_right_jacobian_inverse(xi1_, velocity1_) * w1_;
}

InterpolationWeights GpInterval::weights(double t) const {
  const double s = (t - t0_) / dt_;
  if (!prior_.has_acceleration()) {
    return {dt_ * s * (1.0 - s) * (1.0 - s), s * s * (3.0 - 2.0 * s), -dt_ * s * s * (1.0 - s)};
  }
  return singer::weights(basis_, s, 0);
}

InterpolationWeights GpInterval::rate_weights(double t) const {
  const double s = (t - t0_) / dt_;
  if (!prior_.has_acceleration()) {
    return {(1.0 - s) * (1.0 - 3.0 * s), 6.0 * s * (1.0 - s) / dt_, s * (3.0 * s - 2.0)};
  }
  return singer::weights(basis_, s, 1);
}

Vector6 GpInterval::velocity(double t) const { return se3::right_jacobian(local(t)) * local_rate(t); }

GpInterval::Derivatives GpInterval::derivatives() const {
  const Matrix6 dw_dxi = se3::d_right_jacobian_inverse(xi1_, velocity1_);
  Derivatives d;
  d.xi1_T0 = -se3::left_jacobian_inverse(xi1_);
  d.xi1_T1 = right_inverse_;
  d.w1_T0 = dw_dxi * d.xi1_T0;
  d.w1_T1 = dw_dxi * d.xi1_T1;
  d.w1_v1 = right_inverse_;
  if (prior_.has_acceleration()) {
    const se3::InverseRate rate = se3::right_jacobian_inverse_rate(xi1_, w1_, velocity1_, acceleration1_);
    d.c1_T0 = rate.by_xi * d.xi1_T0 + dw_dxi * d.w1_T0;
    d.c1_T1 = rate.by_xi * d.xi1_T1 + dw_dxi * d.w1_T1;
    d.c1_v1 = rate.by_v + dw_dxi * right_inverse_;
    d.c1_a1 = right_inverse_;
  }
  return d;
}

GpInterval::Query GpInterval::query(double t, const Derivatives& d) const {
  const InterpolationWeights h = weights(t), dh = rate_weights(t);
  const Vector6 xi = combine(h);
  const Vector6 rate = combine(dh);
  const SE3 step = se3::exp(xi);
  const Matrix6 jr = se3::right_jacobian(xi);
  const Matrix6 bend = se3::d_right_jacobian(xi, rate);  // ∂(J_r(ξ)ξ')/∂ξ
  Matrix6 xi_T0 = h.end * d.xi1_T0 + h.end_velocity * d.w1_T0;
  Matrix6 xi_T1 = h.end * d.xi1_T1 + h.end_velocity * d.w1_T1;
  Matrix6 rate_T0 = dh.end * d.xi1_T0 + dh.end_velocity * d.w1_T0;
  Matrix6 rate_T1 = dh.end * d.xi1_T1 + dh.end_velocity * d.w1_T1;
  Query q;
  q.T = T0_ * step;
  q.velocity = jr * rate;
  if (!prior_.has_acceleration()) {
    q.J0.resize(12, 12);
    q.J1.resize(12, 12);
    q.J0 << se3::adjoint(step.inverse()) + jr * xi_T0, h.velocity0 * jr, bend * xi_T0 + jr * rate_T0,
        h.velocity0 * bend + dh.velocity0 * jr;
    q.J1 << jr * xi_T1, h.end_velocity * jr * d.w1_v1, bend * xi_T1 + jr * rate_T1,
        (h.end_velocity * bend + dh.end_velocity * jr) * d.w1_v1;
    return q;
  }
  xi_T0 += h.end_acceleration * d.c1_T0;
  xi_T1 += h.end_acceleration * d.c1_T1;
  rate_T0 += dh.end_acceleration * d.c1_T0;
  rate_T1 += dh.end_acceleration * d.c1_T1;
  const Matrix6 xi_v1 = h.end_velocity * d.w1_v1 + h.end_acceleration * d.c1_v1,
                rate_v1 = dh.end_velocity * d.w1_v1 + dh.end_acceleration * d.c1_v1;
  q.J0.resize(12, 18);
  q.J1.resize(12, 18);
  q.J0 << se3::adjoint(step.inverse()) + jr * xi_T0, h.velocity0 * jr, h.acceleration0 * jr,
      bend * xi_T0 + jr * rate_T0, h.velocity0 * bend + dh.velocity0 * jr,
      h.acceleration0 * bend + dh.acceleration0 * jr;
  q.J1 << jr * xi_T1, jr * xi_v1, h.end_acceleration * jr * d.c1_a1, bend * xi_T1 + jr * rate_T1,
      bend * xi_v1 + jr * rate_v1, (h.end_acceleration * bend + dh.end_acceleration * jr) * d.c1_a1;
  return q;
}

StateVector GpInterval::prior_residual() const {
  StateVector e(prior_.state_size());
  if (!prior_.has_acceleration()) {
    e << xi1_ - dt_ * velocity0_, w1_ - velocity0_;
    return e;
  }
  const Matrix3 phi = singer::transition(dt_, rate_);
  e << xi1_ - dt_ * velocity0_ - phi(0, 2) * acceleration0_, w1_ - velocity0_ - phi(1, 2) * acceleration0_,
      c1_ - phi(2, 2) * acceleration0_;
  return e;
}

Eigen::MatrixXd GpInterval::prior_information_of_axis() const {
  if (prior_.has_acceleration()) return singer::process_covariance(dt_, rate_).inverse();
  const Matrix12 W = wnoa::process_information(dt_, Vector6::Ones());
  return (Matrix2() << W(0, 0), W(0, 6), W(6, 0), W(6, 6)).finished();
}

double GpInterval::prior_cost(const Vector6& qc) const {
  if (!prior_.has_acceleration()) {
    const Vector12 e = prior_residual();
    return 0.5 * e.dot(wnoa::process_information(dt_, qc) * e);
  }
  const Vector18 e = prior_residual();
  const Matrix3 W = prior_information_of_axis();
  double sum = 0.0;
  for (int axis = 0; axis < 6; ++axis) {
    const Vector3 of_axis(e[axis], e[6 + axis], e[12 + axis]);
    sum += of_axis.dot(W * of_axis) / qc[axis];
  }
  return 0.5 * sum;
}

GpInterval::PriorJacobians GpInterval::prior_jacobians(const Derivatives& d) const {
  PriorJacobians j;
  const int n = prior_.state_size();
  j.J0 = j.J1 = StateMatrix::Zero(n, n);
  j.J0.topLeftCorner<12, 12>() << d.xi1_T0, -dt_ * Matrix6::Identity(), d.w1_T0, -Matrix6::Identity();
  j.J1.topLeftCorner<12, 12>() << d.xi1_T1, Matrix6::Zero(), d.w1_T1, d.w1_v1;
  if (prior_.has_acceleration()) {
    const Matrix3 phi = singer::transition(dt_, rate_);
    for (int order = 0; order < 3; ++order) {
      j.J0.block<6, 6>(6 * order, 12) = -phi(order, 2) * Matrix6::Identity();
    }
    j.J0.bottomLeftCorner<6, 6>() = d.c1_T0;
    j.J1.bottomRows<6>() << d.c1_T1, d.c1_v1, d.c1_a1;
  }
  return j;
}

Matrix12 GpInterval::conditional_covariance(double t, const Vector6& qc) const {
  const double tau = t - t0_;
  if (tau <= 0.0 || tau >= dt_) return Matrix12::Zero();
  Matrix12 local_covariance;
  if (prior_.has_acceleration()) {
    const Matrix3 phi = singer::transition(dt_ - tau, rate_);
    const Matrix3 before = singer::process_covariance(tau, rate_), after = singer::process_covariance(dt_ - tau, rate_);
    const Matrix3 total = phi * before * phi.transpose() + after;
    const Matrix3 gain = total.llt().solve(phi * before).transpose(), rest = Matrix3::Identity() - gain * phi;
    const Matrix3 axis = rest * before * rest.transpose() + gain * after * gain.transpose();  // Joseph's form
    local_covariance.setZero();
    for (int r = 0; r < 2; ++r) {
      for (int c = 0; c < 2; ++c) local_covariance.block<6, 6>(6 * r, 6 * c).diagonal() = axis(r, c) * qc;
    }
  } else {
    const Matrix12 phi = wnoa::transition(dt_ - tau);
    const Matrix12 information =
        wnoa::process_information(tau, qc) + phi.transpose() * wnoa::process_information(dt_ - tau, qc) * phi;
    local_covariance = information.llt().solve(Matrix12::Identity());
  }
  const Vector6 xi = local(t);
  Matrix12 map = Matrix12::Zero();  // local (ξ, ξ') → (δT, δϖ)
  map.topLeftCorner<6, 6>() = se3::right_jacobian(xi);
  map.bottomLeftCorner<6, 6>() = se3::d_right_jacobian(xi, local_rate(t));
  map.bottomRightCorner<6, 6>() = map.topLeftCorner<6, 6>();
  return map * local_covariance * map.transpose();
}

Matrix12 GpInterval::covariance(double t, const PairMatrix& states, const Vector6& qc) const {
  const Query q = query(t, derivatives());
  const auto n = q.J0.cols();
  Eigen::Matrix<double, 12, Eigen::Dynamic, Eigen::ColMajor, 12, 36> J(12, 2 * n);
  J << q.J0, q.J1;
  return J * states * J.transpose() + conditional_covariance(t, qc);
}

}  // namespace evbench
