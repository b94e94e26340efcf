#pragma once

#include <Eigen/Geometry>

#include "core/geometry/types.hpp"

namespace evbench {

/// A rigid transformation; as a pose, T_world_camera: p_world = R p_camera + p.
/// Tangents are 6-vectors (rotation, translation) and increments act on the right: T ← T Exp(δ).
struct SE3 {
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();  ///< unit rotation
  Vector3 p = Vector3::Zero();                            ///< translation

  Matrix3 R() const { return q.toRotationMatrix(); }
  SE3 inverse() const {
    const Eigen::Quaterniond qi = q.conjugate();
    return {qi, -(qi * p)};
  }
  /// Composition; the quaternion is normalised so that long products stay rotations.
  SE3 operator*(const SE3& other) const { return {(q * other.q).normalized(), q * other.p + p}; }
  Vector3 operator*(const Vector3& point) const { return q * point + p; }
};

namespace se3 {

/// Exp: (φ, ρ) → (exp φ, J_l(φ) ρ). Barfoot 2017, eq. 7.78.
SE3 exp(const Vector6& xi);

/// Log, with a rotation part of norm ≤ π; exact to rounding near 0 and near π.
Vector6 log(const SE3& T);

/// Ad(T): T Exp(δ) T⁻¹ = Exp(Ad(T) δ).
Matrix6 adjoint(const SE3& T);

/// ad(ξ), the adjoint of the algebra: ad(ξ) η = [ξ, η]; Ad(Exp ξ) = expm(ad(ξ)).
Matrix6 ad(const Vector6& xi);

/// Left and right Jacobians: Exp(ξ + δ) ≈ Exp(J_l δ) Exp(ξ) = Exp(ξ) Exp(J_r δ). Barfoot 2017, eq. 7.85.
Matrix6 left_jacobian(const Vector6& xi);
Matrix6 right_jacobian(const Vector6& xi);

/// Their inverses, for a rotation part of norm < 2π.
Matrix6 left_jacobian_inverse(const Vector6& xi);
Matrix6 right_jacobian_inverse(const Vector6& xi);

/// ∂(J_r(ξ) v)/∂ξ and ∂(J_r(ξ)⁻¹ v)/∂ξ, analytic.
/// J_r and J_r⁻¹ are polynomials in ad(ξ) whose coefficients depend on the rotation angle only, because the minimal
/// polynomial of ad(ξ) is x(x² + θ²)²; the product rule with ∂(ad(ξ)u)/∂ξ = −ad(u) gives the derivative.
Matrix6 d_right_jacobian(const Vector6& xi, const Vector6& v);
Matrix6 d_right_jacobian_inverse(const Vector6& xi, const Vector6& v);

/// d/dt(J_r(ξ)⁻¹ v) = J_r(ξ)⁻¹ v' + ∂(J_r(ξ)⁻¹ v)/∂ξ ξ', and its derivatives by ξ and v at constant ξ' and v'. Those by
/// ξ' and v' are d_right_jacobian_inverse(ξ, v) and J_r(ξ)⁻¹.
struct InverseRate {
  Vector6 value;
  Matrix6 by_xi, by_v;
};
InverseRate right_jacobian_inverse_rate(const Vector6& xi, const Vector6& xi_rate, const Vector6& v,
                                        const Vector6& v_rate);

}  // namespace se3
}  // namespace evbench
