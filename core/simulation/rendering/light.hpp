#pragma once

#include "core/geometry/types.hpp"

namespace evbench {

/// Light that is not even: the logarithm of what falls on a point of the scene (world frame) is gradient · (point −
/// origin), as far as the limit on either side.
struct Light {
  Vector3 gradient = Vector3::Zero();  ///< [1/m]
  Vector3 origin = Vector3::Zero();
  double limit = 0.0;
};

}  // namespace evbench
