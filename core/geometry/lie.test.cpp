#include "core/geometry/lie_coefficients.hpp"
#include "core/geometry/se3.hpp"
#include "core/geometry/so3.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/differences.hpp"

namespace evbench {
namespace {

using testing::central_differences;
using testing::RandomTangents;
using testing::relative_error;

constexpr int kCases = 1000;
constexpr double kTolerance = 1e-6;

Vector6 between(const SE3& a, const SE3& b) { return se3::log(a.inverse() * b); }

}  // namespace

TEST_CASE("Series and closed form of the Lie coefficients agree where they switch") {
  for (const auto& function : {coefficient_b, coefficient_c, inverse_jacobian_coefficient}) {
    const CoefficientJet below = function(1.0 - 1e-12);
    const CoefficientJet above = function(1.0 + 1e-12);
    CHECK(below.f == Approx(above.f).epsilon(1e-11));
    CHECK(below.d == Approx(above.d).epsilon(1e-10));
    CHECK(below.dd == Approx(above.dd).epsilon(1e-8));
  }
}

TEST_CASE("SO(3) log inverts exp from zero to pi") {
  RandomTangents random;
  for (int i = 0; i < kCases; ++i) {
    const Vector3 phi = random.angle(i) * random.direction();
    CHECK((so3::log(so3::exp(phi)) - phi).norm() < 1e-12);
  }
  const Vector3 half_turn = M_PI * Vector3::UnitY();
  CHECK(so3::log(so3::exp(half_turn)).norm() == Approx(M_PI));
}

TEST_CASE("SO(3) Jacobians equal central differences") {
  RandomTangents random;
  for (int i = 0; i < kCases; ++i) {
    const Vector3 phi = random.angle(i) * random.direction();
    const auto right = central_differences<3, 3>(
        [&](const Vector3& d) -> Vector3 { return so3::log(so3::exp(phi).conjugate() * so3::exp(phi + d)); });
    const auto left = central_differences<3, 3>(
        [&](const Vector3& d) -> Vector3 { return so3::log(so3::exp(phi + d) * so3::exp(phi).conjugate()); });
    CHECK(relative_error(so3::right_jacobian(phi), right) < kTolerance);
    CHECK(relative_error(so3::left_jacobian(phi), left) < kTolerance);
    CHECK((so3::right_jacobian_inverse(phi) * so3::right_jacobian(phi) - Matrix3::Identity()).norm() < 1e-11);
    CHECK((so3::left_jacobian_inverse(phi) * so3::left_jacobian(phi) - Matrix3::Identity()).norm() < 1e-11);
  }
}

TEST_CASE("SE(3) log inverts exp from zero to pi") {
  RandomTangents random;
  for (int i = 0; i < kCases; ++i) {
    const Vector6 xi = random.tangent(i);
    CHECK((se3::log(se3::exp(xi)) - xi).norm() < 1e-11);
  }
}

TEST_CASE("SE(3) adjoint transforms a right increment to a left one") {
  RandomTangents random;
  for (int i = 0; i < kCases; ++i) {
    const SE3 T = random.pose();
    const Vector6 xi = 0.3 * random.tangent(i);
    CHECK(between(T * se3::exp(xi), se3::exp(se3::adjoint(T) * xi) * T).norm() < 1e-11);
    CHECK((se3::ad(xi) * xi).norm() < 1e-12);
  }
}

TEST_CASE("SE(3) Jacobians equal central differences") {
  RandomTangents random;
  for (int i = 0; i < kCases; ++i) {
    const Vector6 xi = random.tangent(i);
    const SE3 T = se3::exp(xi);
    const auto right =
        central_differences<6, 6>([&](const Vector6& d) -> Vector6 { return between(T, se3::exp(xi + d)); });
    const auto left = central_differences<6, 6>(
        [&](const Vector6& d) -> Vector6 { return se3::log(se3::exp(xi + d) * T.inverse()); });
    CHECK(relative_error(se3::right_jacobian(xi), right) < kTolerance);
    CHECK(relative_error(se3::left_jacobian(xi), left) < kTolerance);
    CHECK((se3::right_jacobian_inverse(xi) * se3::right_jacobian(xi) - Matrix6::Identity()).norm() < 1e-10);
    CHECK((se3::left_jacobian_inverse(xi) * se3::left_jacobian(xi) - Matrix6::Identity()).norm() < 1e-10);
  }
}

TEST_CASE("Derivatives of SE(3) Jacobians times a vector equal central differences") {
  RandomTangents random;
  for (int i = 0; i < kCases; ++i) {
    const Vector6 xi = random.tangent(i);
    const Vector6 v = random.tangent(i + 5);
    const auto d_right =
        central_differences<6, 6>([&](const Vector6& d) -> Vector6 { return se3::right_jacobian(xi + d) * v; });
    const auto d_inverse =
        central_differences<6, 6>([&](const Vector6& d) -> Vector6 { return se3::right_jacobian_inverse(xi + d) * v; });
    CHECK(relative_error(se3::d_right_jacobian(xi, v), d_right) < kTolerance);
    CHECK(relative_error(se3::d_right_jacobian_inverse(xi, v), d_inverse) < kTolerance);
  }
}

}  // namespace evbench
