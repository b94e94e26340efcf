#include "core/geometry/so3.hpp"

#include <cmath>

#include "core/geometry/lie_coefficients.hpp"

namespace evbench::so3 {

Matrix3 hat(const Vector3& phi) {
  Matrix3 m;
  m << 0.0, -phi.z(), phi.y(), phi.z(), 0.0, -phi.x(), -phi.y(), phi.x(), 0.0;
  return m;
}

Eigen::Quaterniond exp(const Vector3& phi) {
  const double theta_squared = phi.squaredNorm();
  const double theta = std::sqrt(theta_squared);
  // sin(θ/2)/θ; near zero by its series, exact to rounding.
  const double k = theta < 1e-4 ? 0.5 - theta_squared / 48.0 : std::sin(0.5 * theta) / theta;
  return {std::cos(0.5 * theta), k * phi.x(), k * phi.y(), k * phi.z()};
}

Vector3 log(const Eigen::Quaterniond& q) {
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  const Vector3 v = sign * q.vec();
  const double w = sign * q.w();
  const double s = v.norm();
  // 2 atan2(s, w)/s; below the bound by its series in s/w.
  const double k = s < 1e-6 ? 2.0 / w - 2.0 * s * s / (3.0 * w * w * w) : 2.0 * std::atan2(s, w) / s;
  return k * v;
}

Matrix3 left_jacobian(const Vector3& phi) {
  const double z = phi.squaredNorm();
  const Matrix3 k = hat(phi);
  return Matrix3::Identity() + coefficient_b(z).f * k + coefficient_c(z).f * k * k;
}

Matrix3 right_jacobian(const Vector3& phi) { return left_jacobian(-phi); }

Matrix3 left_jacobian_inverse(const Vector3& phi) {
  const Matrix3 k = hat(phi);
  return Matrix3::Identity() - 0.5 * k + inverse_jacobian_coefficient(phi.squaredNorm()).f * k * k;
}

Matrix3 right_jacobian_inverse(const Vector3& phi) { return left_jacobian_inverse(-phi); }

}  // namespace evbench::so3
