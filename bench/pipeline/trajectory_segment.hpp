#pragma once

#include <optional>
#include <vector>

#include "core/data/landmark.hpp"
#include "core/data/causal_poses.hpp"
#include "core/data/problem.hpp"
#include "core/data/relative_poses.hpp"
#include "core/geometry/similarity.hpp"
#include "core/motion/pose_trajectory.hpp"

namespace evbench {

/// A part of the estimate in one world frame and scale: by one back-end, until it was lost or the run ended, and by
/// those after it that were found in its world.
struct TrajectorySegment {
  PoseTrajectory final_trajectory;   ///< after the fact, at the rate asked for; no poses while lost
  PoseTrajectory causal_trajectory;  ///< causal, the back-end's own times: each pose as it was first told
  std::vector<CausalPose> published;      ///< all that was told while the data came in, known_at set
  std::vector<Landmark> map;
  /// That the back-end ended with, where it has one: of several, the first one's.
  std::optional<Problem> problem;
  /// With covariances, where the back-end has them: "newest", poses told while the data came in, since the first pose;
  /// "over_100ms" and "over_1s", of the final estimate.
  std::vector<RelativePose> relative;

  double covered = 0.0;  ///< [s], of the final trajectory, without the time while lost
};

/// In the world to which `transform` carries that of the pose: body velocities scale with it.
CausalPose carried(CausalPose pose, const Similarity& transform);

/// A later segment goes on in the world of an earlier one, to which `transform` carries its own. What it told then,
/// `told`, is in that world already. Landmarks that both have are where the later one saw them.
void go_on(TrajectorySegment& segment, TrajectorySegment later, const Similarity& transform, std::vector<CausalPose> published);

/// Each pose that was the newest when it was published.
PoseTrajectory newest_poses(const std::vector<CausalPose>& published);

}  // namespace evbench
