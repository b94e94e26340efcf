#pragma once

#include <array>
#include <span>

#include "core/data/relative_poses.hpp"
#include "core/motion/pose_trajectory.hpp"
#include "core/plugin/options.hpp"

namespace evbench {

/// Whether errors are as large as covariances say. With e the error of a relative pose, T_truth = T Exp(e), and C = L
/// Lᵀ its covariance, the six components of L⁻¹e are independent and standard normal where C is right.
struct CovarianceScores {
  std::size_t n = 0;               ///< relative poses compared
  std::size_t singular = 0;        ///< covariances that are not positive definite: not compared
  double nees = 0.0;               ///< mean of |L⁻¹e|² / 6: 1 where C is right, above where it promises too much
  std::array<double, 3> within{};  ///< share of the components of L⁻¹e within 1, 2, 3: 0.683, 0.954, 0.997 likewise
};

/// `scale` carries the estimate's unit to metres: it is applied to translations, and to the rows and columns of the
/// covariances that are of them. `time_offset` [s] is added to the estimate's times. Poses of which the ground truth
/// (interpolated) lacks an end are passed over.
CovarianceScores score_covariances(std::span<const RelativePose> poses, const PoseTrajectory& ground_truth,
                                   double scale, double time_offset);

/// The structure that docs/reference/metrics.md documents.
Json to_json(const CovarianceScores& scores);

}  // namespace evbench
