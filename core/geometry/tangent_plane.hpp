#pragma once

#include <Eigen/Geometry>

#include "core/geometry/types.hpp"

namespace evbench {

/// Two unit vectors across a unit vector and across each other, which span the plane that touches the sphere there.
inline Eigen::Matrix<double, 3, 2> tangent_plane(const Vector3& direction) {
  Eigen::Matrix<double, 3, 2> result;
  result.col(0) = direction.unitOrthogonal();
  result.col(1) = direction.cross(result.col(0));
  return result;
}

}  // namespace evbench
