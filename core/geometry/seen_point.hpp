#pragma once

#include "core/geometry/so3.hpp"

namespace evbench {

/// The derivative of q = T⁻¹ l, a point l as it is seen from a pose T = T_world_camera, with respect to δ in
/// T ← T Exp(δ): q ← Exp(−δ) q changes by [q]× δφ − δρ.
inline Eigen::Matrix<double, 3, 6> seen_point_jacobian(const Vector3& q) {
  Eigen::Matrix<double, 3, 6> J;
  J << so3::hat(q), -Matrix3::Identity();
  return J;
}

}  // namespace evbench
