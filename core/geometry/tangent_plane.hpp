#pragma once

#include <Eigen/Geometry>

#include "core/geometry/types.hpp"

namespace evbench {

/// Two orthonormal vectors orthogonal to a unit vector: a basis of the tangent plane of the unit sphere there.
inline Eigen::Matrix<double, 3, 2> tangent_plane(const Vector3& direction) {
  Eigen::Matrix<double, 3, 2> result;
  result.col(0) = direction.unitOrthogonal();
  result.col(1) = direction.cross(result.col(0));
  return result;
}

}  // namespace evbench
