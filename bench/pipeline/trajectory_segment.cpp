#include "bench/pipeline/trajectory_segment.hpp"

#include <map>
#include <utility>

namespace evbench {
namespace {

RelativePose scaled(RelativePose relative, double scale) {
  relative.T.p *= scale;
  relative.covariance.bottomRows<3>() *= scale;
  relative.covariance.rightCols<3>() *= scale;
  return relative;
}

}  // namespace

CausalPose transformed(CausalPose pose, const Similarity& transform) {
  pose.T = transform * pose.T;
  if (pose.velocity) pose.velocity->tail<3>() *= transform.scale;
  return pose;
}

void append(TrajectorySegment& segment, TrajectorySegment later, const Similarity& transform,
            std::vector<CausalPose> published) {
  segment.covered += later.covered;
  std::vector<StampedPose> poses = std::move(segment.final_trajectory).poses();
  const double end = poses.back().t;
  for (const StampedPose& pose : later.final_trajectory.poses()) {
    if (pose.t > end) poses.push_back({pose.t, transform * pose.T});
  }
  segment.final_trajectory = PoseTrajectory(std::move(poses), "the back-ends' trajectory");
  for (StampedVelocity velocity : later.velocities) {
    if (!(velocity.t > end)) continue;
    velocity.velocity.tail<3>() *= transform.scale;
    segment.velocities.push_back(velocity);
  }
  segment.published.insert(segment.published.end(), published.begin(), published.end());
  segment.causal_trajectory = newest_poses(segment.published);
  std::map<TrackId, Vector3> map;
  for (const Landmark& landmark : segment.map) map[landmark.track] = landmark.position;
  for (const Landmark& landmark : later.map) map[landmark.track] = transform * landmark.position;
  segment.map.clear();
  for (const auto& [track, position] : map) segment.map.push_back({track, position});
  for (RelativePose& relative : later.relative) {
    segment.relative.push_back(scaled(std::move(relative), transform.scale));
  }
}

PoseTrajectory newest_poses(const std::vector<CausalPose>& published) {
  std::vector<StampedPose> poses;
  for (const CausalPose& pose : published) {
    if (poses.empty() || pose.t > poses.back().t) poses.push_back(pose);
  }
  return PoseTrajectory(std::move(poses), "the causal trajectory");
}

}  // namespace evbench
