#pragma once

#include <optional>
#include <vector>

#include "core/data/causal_poses.hpp"
#include "core/data/landmark.hpp"
#include "core/data/problem.hpp"
#include "core/data/relative_poses.hpp"
#include "core/geometry/similarity.hpp"
#include "core/motion/body_velocities.hpp"
#include "core/motion/pose_trajectory.hpp"

namespace evbench {

/// Part of the estimate in one world frame and scale: the estimate of one back-end until it was lost or the run ended,
/// followed by those of later back-ends that were relocalised in its world.
struct TrajectorySegment {
  PoseTrajectory final_trajectory;          ///< smoothed estimate at the rate of the run; no poses while lost
  std::vector<StampedVelocity> velocities;  ///< at its poses' times, if the back-end has velocities
  PoseTrajectory causal_trajectory;         ///< poses as first published, at the back-end's own times
  std::vector<CausalPose> published;        ///< all published poses, known_at set
  std::vector<Landmark> map;
  /// The final problem of the back-end, if it has that form; of several back-ends, that of the first.
  std::optional<Problem> problem;
  /// Relative poses with covariances, if the back-end has them: "newest", published poses relative to the first pose;
  /// "over_100ms" and "over_1s", of the final estimate.
  std::vector<RelativePose> relative;

  double covered = 0.0;  ///< [s] duration of the final trajectory, without the time while lost
};

/// Transforms a pose to another world; the linear body velocity scales with the transform.
CausalPose transformed(CausalPose pose, const Similarity& transform);

/// Appends the segment of a later, relocalised back-end. `transform` maps its world to that of `segment`. `published`:
/// its published poses, already in the world of `segment`. A landmark of both has the position of the later one.
void append(TrajectorySegment& segment, TrajectorySegment later, const Similarity& transform,
            std::vector<CausalPose> published);

/// The poses that were the newest when they were published.
PoseTrajectory newest_poses(const std::vector<CausalPose>& published);

}  // namespace evbench
