#include "core/motion/gp_interval.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <array>
#include <cmath>

#include "core/motion/wnoa.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/differences.hpp"

namespace evbench {
namespace {

using testing::central_differences;
using testing::RandomTangents;
using testing::relative_error;

constexpr double kTolerance = 1e-6;

const MotionPrior kWnoa;
MotionPrior singer_prior(int i) { return {std::array{2.0, 20.0, 60.0, 1e3}[static_cast<std::size_t>(i % 4)]}; }

/// Two states whose relative rotation covers all angles up to almost π.
std::pair<ControlState, ControlState> neighbours(RandomTangents& random, int i) {
  ControlState a, b;
  a.t = random.uniform(-5.0, 5.0);
  b.t = a.t + random.uniform(0.01, 0.5);
  a.T = random.pose();
  b.T = a.T * se3::exp(random.tangent(i));
  a.velocity << random.uniform(0, 3) * random.direction(), random.uniform(0, 3) * random.direction();
  b.velocity << random.uniform(0, 3) * random.direction(), random.uniform(0, 3) * random.direction();
  return {a, b};
}

/// The same with accelerations.
std::pair<ControlState, ControlState> accelerated(RandomTangents& random, int i) {
  auto [a, b] = neighbours(random, i);
  for (ControlState* state : {&a, &b}) {
    state->acceleration << random.uniform(0, 20) * random.direction(), random.uniform(0, 20) * random.direction();
  }
  return {a, b};
}

/// Calls check(random, number, interval, moved) 1,000 times; moved(δ) is the interval with both states incremented.
template <int Orders, class Check>
void for_random_intervals(Check check) {
  using Pair = Eigen::Matrix<double, 12 * Orders, 1>;
  RandomTangents random;
  for (int i = 0; i < 1000; ++i) {
    const bool singer = Orders == 3;
    const MotionPrior prior = singer ? singer_prior(i) : kWnoa;
    const auto states = singer ? accelerated(random, i) : neighbours(random, i);
    const ControlState a = states.first, b = states.second;
    check(random, i, GpInterval(a, b, prior), [&](const Pair& d) {
      return GpInterval(a.retract(d.template head<6 * Orders>()), b.retract(d.template tail<6 * Orders>()), prior);
    });
  }
}

template <int Orders>
void check_interpolation_jacobians() {
  constexpr int kState = 6 * Orders, kPair = 2 * kState;
  for_random_intervals<Orders>([](RandomTangents& random, int i, const GpInterval& interval, auto moved) {
    const double s = i % 5 == 0 ? 1.0 : i % 5 == 1 ? 0.0 : random.uniform(0.0, 1.0);
    const double t = interval.t0() + s * interval.dt();
    const GpInterval::Query query = interval.query(t, interval.derivatives());
    CHECK(se3::log(query.T.inverse() * interval.pose(t)).norm() < 1e-12);
    const auto J = central_differences<12, kPair>([&](const Eigen::Matrix<double, kPair, 1>& d) -> Vector12 {
      const GpInterval other = moved(d);
      Vector12 value;
      value << se3::log(query.T.inverse() * other.pose(t)), other.velocity(t);
      return value;
    });
    CHECK(relative_error(query.J0, J.template leftCols<kState>()) < kTolerance);
    CHECK(relative_error(query.J1, J.template rightCols<kState>()) < kTolerance);
  });
}

template <int Orders>
void check_prior_jacobians() {
  constexpr int kState = 6 * Orders, kPair = 2 * kState;
  for_random_intervals<Orders>([](RandomTangents&, int, const GpInterval& interval, auto moved) {
    const auto J = central_differences<kState, kPair>(
        [&](const Eigen::Matrix<double, kPair, 1>& d) -> Eigen::Matrix<double, kState, 1> {
          return moved(d).prior_residual();
        });
    const GpInterval::PriorJacobians jacobians = interval.prior_jacobians(interval.derivatives());
    CHECK(relative_error(jacobians.J0, J.template leftCols<kState>()) < kTolerance);
    CHECK(relative_error(jacobians.J1, J.template rightCols<kState>()) < kTolerance);
  });
}

}  // namespace

TEST_CASE("Interpolation equals both control states in pose and velocity") {
  RandomTangents random;
  for (int i = 0; i < 2000; ++i) {
    const auto [a, b] = accelerated(random, i);
    const GpInterval interval(a, b, i % 2 == 0 ? kWnoa : singer_prior(i / 2));
    const double rounding = i % 2 == 0 ? 1e-9 : 1e-8;  // Singer's basis has a condition number of up to 1e4
    CHECK(se3::log(interval.pose(a.t).inverse() * a.T).norm() < 1e-12);
    CHECK(se3::log(interval.pose(b.t).inverse() * b.T).norm() < 1e-10);
    CHECK((interval.velocity(a.t) - a.velocity).norm() < 1e-12);
    CHECK((interval.velocity(b.t) - b.velocity).norm() < rounding * (1.0 + b.velocity.norm()));
  }
}

TEST_CASE("Interpolated velocity is the time derivative of the interpolated pose") {
  RandomTangents random;
  for (int i = 0; i < 2000; ++i) {
    const auto [a, b] = accelerated(random, i);
    const GpInterval interval(a, b, i % 2 == 0 ? kWnoa : singer_prior(i / 2));
    const double t = a.t + random.uniform(0.1, 0.9) * interval.dt();
    const SE3 T = interval.pose(t);
    const Eigen::Matrix<double, 6, 1> rate = central_differences<6, 1>(
        [&](const Eigen::Matrix<double, 1, 1>& d) -> Vector6 {
          return se3::log(T.inverse() * interval.pose(t + d[0]));
        },
        1e-3 * interval.dt());
    CHECK(relative_error(interval.velocity(t), rate) < kTolerance);
  }
}

TEST_CASE("With Singer's prior the interpolated acceleration equals that of both control states") {
  RandomTangents random;
  for (int i = 0; i < 500; ++i) {
    const auto [a, b] = accelerated(random, i);
    const GpInterval interval(a, b, singer_prior(i));
    const double h = 1e-4 * interval.dt();
    const auto slope = [&](double t, double step) -> Vector6 {  // one-sided, of third order
      return (-11.0 * interval.velocity(t) + 18.0 * interval.velocity(t + step) -
              9.0 * interval.velocity(t + 2.0 * step) + 2.0 * interval.velocity(t + 3.0 * step)) /
             (6.0 * step);
    };
    CHECK(relative_error(slope(a.t, h), a.acceleration) < 1e-3);
    CHECK(relative_error(slope(b.t, -h), b.acceleration) < 1e-3);
  }
}

TEST_CASE("Singer's interpolation is the GP's conditional mean, its limits are the quintic and the cubic polynomial") {
  for (const double rate : {0.01, 1.0, 20.0, 60.0}) {
    const double dt = 0.2;
    CAPTURE(rate);
    const singer::Basis basis(dt, rate);
    for (const double s : {0.05, 0.3, 0.5, 0.8, 0.97}) {
      const double tau = s * dt;
      const Matrix3 psi = singer::process_covariance(tau, rate) * singer::transition(dt - tau, rate).transpose() *
                          singer::process_covariance(dt, rate).inverse();
      const Matrix3 lambda = singer::transition(tau, rate) - psi * singer::transition(dt, rate);
      for (int derivative = 0; derivative < 3; ++derivative) {
        const InterpolationWeights w = singer::weights(basis, s, derivative);
        const double unit = std::pow(dt, -derivative);
        CHECK(w.velocity0 == Approx(lambda(derivative, 1)).margin(1e-6 * dt * unit));
        CHECK(w.acceleration0 == Approx(lambda(derivative, 2)).margin(1e-6 * dt * dt * unit));
        CHECK(w.end == Approx(psi(derivative, 0)).margin(1e-6 * unit));
        CHECK(w.end_velocity == Approx(psi(derivative, 1)).margin(1e-6 * dt * unit));
        CHECK(w.end_acceleration == Approx(psi(derivative, 2)).margin(1e-6 * dt * dt * unit));
      }
      const InterpolationWeights slow = singer::weights(singer::Basis(dt, 1e-3), s, 0);
      CHECK(slow.end == Approx(s * s * s * (10.0 - 15.0 * s + 6.0 * s * s)));
    }
  }
  // Φ and Q for a slow rate are those of white noise on jerk, times α² for the latter.
  const double dt = 0.3, rate = 1e-4;
  const Matrix3 Q = singer::process_covariance(dt, rate) / (rate * rate);
  CHECK(Q(0, 0) == Approx(std::pow(dt, 5) / 20.0).epsilon(1e-3));
  CHECK(Q(2, 1) == Approx(dt * dt / 2.0).epsilon(1e-3));
  CHECK(singer::transition(dt, rate)(0, 2) == Approx(dt * dt / 2.0).epsilon(1e-3));
  // For a fast one pose and velocity have WNOA's.
  CHECK(singer::process_covariance(dt, 1e5)(0, 0) == Approx(dt * dt * dt / 3.0).epsilon(1e-3));
  CHECK(singer::process_covariance(dt, 1e5)(1, 1) == Approx(dt).epsilon(1e-2));
}

TEST_CASE("Singer's covariance accumulates by its transition, and its stationary acceleration stays") {
  for (const double rate : {0.5, 20.0, 60.0}) {
    const double dt = 0.1;
    const Matrix3 Q = singer::process_covariance(dt, rate), phi = singer::transition(dt, rate);
    const Matrix3 twice = phi * Q * phi.transpose() + Q;
    CHECK((twice - singer::process_covariance(2.0 * dt, rate)).norm() < 1e-9 * twice.norm());
    CHECK((phi * phi - singer::transition(2.0 * dt, rate)).norm() < 1e-12);
    CHECK(phi(2, 2) * phi(2, 2) * 0.5 * rate + Q(2, 2) == Approx(0.5 * rate));
  }
}

TEST_CASE("Constant velocity is interpolated exactly and has zero prior cost") {
  RandomTangents random;
  for (int i = 0; i < 100; ++i) {
    auto [a, b] = neighbours(random, i);
    b = extrapolate(a, b.t - a.t);
    const GpInterval interval(a, b);
    const double t = a.t + 0.37 * interval.dt();
    CHECK(se3::log(interval.pose(t).inverse() * extrapolate(a, t - a.t).T).norm() < 1e-12);
    CHECK(interval.prior_residual().norm() < 1e-11);
  }
}

TEST_CASE("Interpolation Jacobians equal central differences") {
  check_interpolation_jacobians<2>();
  check_interpolation_jacobians<3>();
}

TEST_CASE("Motion prior Jacobians equal central differences") {
  check_prior_jacobians<2>();
  check_prior_jacobians<3>();
}

TEST_CASE("The prior's information matrix is the inverse of its covariance") {
  const Vector6 qc = (Vector6() << 0.1, 0.2, 0.3, 1.0, 2.0, 3.0).finished();
  for (const double dt : {1e-3, 0.05, 2.0}) {
    const Matrix12 product = wnoa::process_covariance(dt, qc) * wnoa::process_information(dt, qc);
    CHECK((product - Matrix12::Identity()).norm() < 1e-9);
  }
}

TEST_CASE("Covariance between two states equals the dense GP posterior for small motions") {
  // Around the identity SE(3) is a vector space to first order: the closed-form GP is the reference.
  ControlState a, b;
  b.t = 0.4;
  const Vector6 qc = (Vector6() << 0.1, 0.2, 0.3, 1.0, 2.0, 3.0).finished();
  const GpInterval interval(a, b);
  const double t = 0.15;
  // Joint distribution of (x(0), x(t), x(0.4)) with x(0) ~ N(0, P0), unconditioned: the result is the marginal of x(t).
  const Matrix12 P0 = 0.01 * Matrix12::Identity();
  const Matrix12 phi1 = wnoa::transition(t), phi = wnoa::transition(b.t);
  Eigen::Matrix<double, 24, 24> joint;
  joint << P0, P0 * phi.transpose(), phi * P0, phi * P0 * phi.transpose() + wnoa::process_covariance(b.t, qc);
  const Matrix12 expected = phi1 * P0 * phi1.transpose() + wnoa::process_covariance(t, qc);
  CHECK(relative_error(interval.covariance(t, joint, qc), expected) < 1e-9);
  CHECK(interval.conditional_covariance(0.0, qc).norm() == 0.0);

  const double rate = 20.0;
  const GpInterval singer_interval(a, b, {rate});
  const Matrix3 phi3 = singer::transition(b.t, rate), phi31 = singer::transition(t, rate);
  Matrix18 begin = 0.01 * Matrix18::Identity(), end, cross, middle;
  const auto of_axes = [](const Matrix3& axis, const Vector6& scale) {
    Matrix18 m = Matrix18::Zero();
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) m.block<6, 6>(6 * r, 6 * c).diagonal() = axis(r, c) * scale;
    }
    return m;
  };
  const Matrix18 forward = of_axes(phi3, Vector6::Ones()), to_t = of_axes(phi31, Vector6::Ones());
  end = forward * begin * forward.transpose() + of_axes(singer::process_covariance(b.t, rate), qc);
  cross = forward * begin;
  middle = to_t * begin * to_t.transpose() + of_axes(singer::process_covariance(t, rate), qc);
  PairMatrix both(36, 36);
  both << begin, cross.transpose(), cross, end;
  CHECK(relative_error(singer_interval.covariance(t, both, qc), middle.topLeftCorner<12, 12>()) < 1e-7);
}

TEST_CASE("A state is extrapolated with constant velocity, forwards and backwards") {
  ControlState a;
  a.t = 1.0;
  a.velocity[3] = 2.0;
  CHECK(extrapolate(a, 0.5).T.p.x() == Approx(1.0));
  CHECK(extrapolate(a, -0.5).T.p.x() == Approx(-1.0));
  CHECK(extrapolate(a, 0.5).t == 1.5);
}

TEST_CASE("With Singer's prior an extrapolated state is the expected one") {
  RandomTangents random;
  for (int i = 0; i < 200; ++i) {
    const ControlState a = accelerated(random, i).first;
    const MotionPrior prior = singer_prior(i);
    const double dt = std::min(random.uniform(0.01, 0.2), 10.0 / prior.rate);
    ControlState b = extrapolate(a, dt, prior);
    const GpInterval interval(a, b, prior);
    CHECK(interval.prior_residual().head<12>().norm() < 1e-9);
    CHECK(extrapolate(a, -0.1, prior).T.p.isApprox(extrapolate(a, -0.1).T.p));
  }
}

}  // namespace evbench
