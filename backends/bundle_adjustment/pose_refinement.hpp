#pragma once

#include <span>

#include "backends/bundle_adjustment/reconstruction.hpp"
#include "backends/bundle_adjustment/reprojection.hpp"

namespace evbench::bundle_adjustment {

struct PoseEstimate {
  SE3 T;
  double median_px = 0.0;  ///< of the reprojection error's norm
};

/// The pose from which the landmarks are seen at the keypoints: Levenberg-Marquardt from a prediction, landmarks held.
/// If that ends with a median error above `limit_px`, PnP with RANSAC (OpenCV, fixed seed) gives a second start, and
/// the better result is kept. `loss` may be null.
PoseEstimate estimate_pose(const SE3& prediction, const Reconstruction& map, std::span<const Keypoint> keypoints,
                           const PinholeCamera& camera, const ceres::LossFunction* loss, double limit_px);

}  // namespace evbench::bundle_adjustment
