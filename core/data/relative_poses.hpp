#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/geometry/se3.hpp"

namespace evbench {

/// A relative pose as it was estimated, with its covariance.
struct RelativePose {
  std::string kind;                      ///< what it is an example of; one word
  double t0 = 0.0, t1 = 0.0;             ///< [s]
  SE3 T;                                 ///< T(t0)⁻¹ T(t1)
  Matrix6 covariance = Matrix6::Zero();  ///< of δ, T ← T Exp(δ)
};

/// A file of them, a line each: kind t0 t1 x y z qx qy qz qw, then the covariance's 36 numbers row by row. Numbers read
/// back as the same.
std::string format_relative_poses(std::span<const RelativePose> poses);

/// Throws InputError, with file and line, for a damaged file.
std::vector<RelativePose> read_relative_poses(const std::string& path);

}  // namespace evbench
