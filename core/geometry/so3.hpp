#pragma once

#include <Eigen/Geometry>

#include "core/geometry/types.hpp"

namespace evbench::so3 {

/// The skew matrix φ^ with φ^ a = φ × a.
Matrix3 hat(const Vector3& phi);

/// Unit quaternion of the rotation vector φ [rad].
Eigen::Quaterniond exp(const Vector3& phi);

/// Rotation vector with |φ| ≤ π of a unit quaternion; exact to rounding near 0 and near π.
Vector3 log(const Eigen::Quaterniond& q);

/// Left and right Jacobians: exp(φ + δ) ≈ exp(J_l δ) exp(φ) = exp(φ) exp(J_r δ). Barfoot 2017, eq. 7.77.
Matrix3 left_jacobian(const Vector3& phi);
Matrix3 right_jacobian(const Vector3& phi);

/// Their inverses, for |φ| < 2π.
Matrix3 left_jacobian_inverse(const Vector3& phi);
Matrix3 right_jacobian_inverse(const Vector3& phi);

}  // namespace evbench::so3
