#pragma once

#include <array>
#include <span>

#include "core/data/relative_poses.hpp"
#include "core/motion/pose_trajectory.hpp"
#include "core/plugin/options.hpp"

namespace evbench {

/// Consistency of covariances with errors. With e the error of a relative pose, T_truth = T Exp(e), and C = L Lᵀ its
/// covariance, the six components of L⁻¹e are independent and standard normal if C is correct.
struct CovarianceScores {
  std::size_t n = 0;               ///< relative poses compared
  std::size_t singular = 0;        ///< covariances that are not positive definite: not compared
  double nees = 0.0;               ///< mean of |L⁻¹e|² / 6: 1 if C is correct, above 1 if it is overconfident
  std::array<double, 3> within{};  ///< share of the components of L⁻¹e within 1, 2, 3: ideally 0.683, 0.954, 0.997
};

/// `scale`: metres per unit of the estimate, applied to translations and to their rows and columns of the covariances.
/// `time_offset` [s] is added to the estimate's times. Relative poses without (interpolated) ground truth at both ends
/// are skipped.
CovarianceScores score_covariances(std::span<const RelativePose> poses, const PoseTrajectory& ground_truth,
                                   double scale, double time_offset);

/// The structure that docs/reference/metrics.md documents.
Json to_json(const CovarianceScores& scores);

}  // namespace evbench
