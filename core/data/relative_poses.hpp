#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/geometry/se3.hpp"

namespace evbench {

/// An estimated relative pose with its covariance.
struct RelativePose {
  std::string kind;                      ///< category, one word
  double t0 = 0.0, t1 = 0.0;             ///< [s]
  SE3 T;                                 ///< T(t0)⁻¹ T(t1)
  Matrix6 covariance = Matrix6::Zero();  ///< of δ, T ← T Exp(δ)
};

/// The content of a file of relative poses, one per line: kind t0 t1 x y z qx qy qz qw, then the 36 numbers of the
/// covariance row by row. Numbers are read back unchanged.
std::string format_relative_poses(std::span<const RelativePose> poses);

/// Reads such a file. Throws InputError with file and line for a damaged file.
std::vector<RelativePose> read_relative_poses(const std::string& path);

}  // namespace evbench
