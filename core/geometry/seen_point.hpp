#pragma once

#include "core/geometry/so3.hpp"

namespace evbench {

/// Jacobian of q = T⁻¹ l, a world point l in the camera frame of T = T_world_camera, with respect to δ in T ← T Exp(δ):
/// q ← Exp(−δ) q changes by [q]× δφ − δρ.
inline Eigen::Matrix<double, 3, 6> seen_point_jacobian(const Vector3& q) {
  Eigen::Matrix<double, 3, 6> J;
  J << so3::hat(q), -Matrix3::Identity();
  return J;
}

}  // namespace evbench
