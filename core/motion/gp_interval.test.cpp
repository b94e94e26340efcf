#include "core/motion/gp_interval.hpp"

#include <Eigen/Cholesky>

#include "core/motion/wnoa.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/differences.hpp"

namespace evbench {
namespace {

using testing::central_differences;
using testing::RandomTangents;
using testing::relative_error;

constexpr double kTolerance = 1e-6;
using Vector24 = Eigen::Matrix<double, 24, 1>;

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

}  // namespace

TEST_CASE("Interpolation equals both control states in pose and velocity") {
  RandomTangents random;
  for (int i = 0; i < 1000; ++i) {
    const auto [a, b] = neighbours(random, i);
    const GpInterval interval(a, b);
    CHECK(se3::log(interval.pose(a.t).inverse() * a.T).norm() < 1e-12);
    CHECK(se3::log(interval.pose(b.t).inverse() * b.T).norm() < 1e-10);
    CHECK((interval.velocity(a.t) - a.velocity).norm() < 1e-12);
    CHECK((interval.velocity(b.t) - b.velocity).norm() < 1e-9 * (1.0 + b.velocity.norm()));
  }
}

TEST_CASE("Interpolated velocity is the time derivative of the interpolated pose") {
  RandomTangents random;
  for (int i = 0; i < 1000; ++i) {
    const auto [a, b] = neighbours(random, i);
    const GpInterval interval(a, b);
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
  RandomTangents random;
  for (int i = 0; i < 1000; ++i) {
    const auto pair = neighbours(random, i);
    const ControlState a = pair.first, b = pair.second;
    const GpInterval interval(a, b);
    const double s = i % 5 == 0 ? 1.0 : i % 5 == 1 ? 0.0 : random.uniform(0.0, 1.0);
    const double t = a.t + s * interval.dt();
    const GpInterval::Query query = interval.query(t, interval.derivatives());
    CHECK(se3::log(query.T.inverse() * interval.pose(t)).norm() < 1e-12);
    const auto J = central_differences<12, 24>([&](const Vector24& d) -> Vector12 {
      const GpInterval moved(a.retract(d.head<12>()), b.retract(d.tail<12>()));
      Vector12 value;
      value << se3::log(query.T.inverse() * moved.pose(t)), moved.velocity(t);
      return value;
    });
    CHECK(relative_error(query.J0, J.leftCols<12>()) < kTolerance);
    CHECK(relative_error(query.J1, J.rightCols<12>()) < kTolerance);
  }
}

TEST_CASE("Motion prior Jacobians equal central differences") {
  RandomTangents random;
  for (int i = 0; i < 1000; ++i) {
    const auto pair = neighbours(random, i);
    const ControlState a = pair.first, b = pair.second;
    const GpInterval interval(a, b);
    const auto J = central_differences<12, 24>([&](const Vector24& d) -> Vector12 {
      return GpInterval(a.retract(d.head<12>()), b.retract(d.tail<12>())).prior_residual();
    });
    const GpInterval::PriorJacobians jacobians = interval.prior_jacobians(interval.derivatives());
    CHECK(relative_error(jacobians.J0, J.leftCols<12>()) < kTolerance);
    CHECK(relative_error(jacobians.J1, J.rightCols<12>()) < kTolerance);
  }
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
}

TEST_CASE("A state is extrapolated with constant velocity, forwards and backwards") {
  ControlState a;
  a.t = 1.0;
  a.velocity[3] = 2.0;
  CHECK(extrapolate(a, 0.5).T.p.x() == Approx(1.0));
  CHECK(extrapolate(a, -0.5).T.p.x() == Approx(-1.0));
  CHECK(extrapolate(a, 0.5).t == 1.5);
}

}  // namespace evbench
