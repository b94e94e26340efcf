#pragma once

#include <cmath>

#include "core/geometry/so3.hpp"
#include "core/motion/pose_trajectory.hpp"
#include "eval/alignment.hpp"

namespace evbench::testing {

/// A smooth motion with rotation about all axes.
inline SE3 wavy_pose(double t) {
  return {so3::exp({0.3 * std::sin(1.1 * t), 0.4 * std::cos(0.7 * t), 0.5 * std::sin(0.5 * t + 1.0)}),
          {std::sin(t), std::cos(0.8 * t), 0.5 * std::sin(1.7 * t)}};
}

/// Poses of any motion (a function of time) at start, start + step, ...
template <class Motion>
PoseTrajectory sample(const Motion& motion, int count, double step = 0.01, double start = 0.0) {
  std::vector<StampedPose> poses;
  for (int i = 0; i < count; ++i) poses.push_back({start + i * step, motion(start + i * step)});
  return PoseTrajectory(std::move(poses));
}

/// The poses in another world frame: moved by `transform`'s inverse, so that alignment gives `transform`.
inline PoseTrajectory seen_from(const PoseTrajectory& trajectory, const Similarity& transform) {
  const Similarity inverse = transform.inverse();
  std::vector<StampedPose> poses;
  for (const StampedPose& pose : trajectory.poses()) poses.push_back({pose.t, inverse * pose.T});
  return PoseTrajectory(std::move(poses));
}

/// Reproducible errors of a few centimetres and degrees.
inline PoseTrajectory disturbed(const PoseTrajectory& trajectory, double size = 0.02) {
  std::vector<StampedPose> poses;
  for (const StampedPose& pose : trajectory.poses()) {
    Vector6 error;
    for (int k = 0; k < 6; ++k) error[k] = size * std::sin(37.0 * pose.t + 1.3 * k);
    poses.push_back({pose.t, pose.T * se3::exp(error)});
  }
  return PoseTrajectory(std::move(poses));
}

inline std::vector<PosePair> paired(const PoseTrajectory& ground_truth, const PoseTrajectory& estimate) {
  std::vector<PosePair> pairs;
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    pairs.push_back({estimate.poses()[i].t, ground_truth.poses()[i].T, estimate.poses()[i].T});
  }
  return pairs;
}

}  // namespace evbench::testing
