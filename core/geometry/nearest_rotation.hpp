#pragma once

#include "core/geometry/types.hpp"

namespace evbench {

/// The rotation R that maximises tr(Rᵀ M), which is also the nearest to M (Frobenius norm), with parts of the singular
/// value decomposition of M. Umeyama 1991.
struct NearestRotation {
  Matrix3 R;
  double trace = 0.0;             ///< tr(Rᵀ M)
  Vector3 values = {0, 0, 0};     ///< singular values of M, in decreasing order
  Vector3 direction = {0, 0, 1};  ///< right singular vector of the largest
};

NearestRotation nearest_rotation(const Matrix3& M);

}  // namespace evbench
