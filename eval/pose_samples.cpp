#include "eval/pose_samples.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>

namespace evbench {
namespace {

/// The pose at t; none outside the trajectory and in its holes, longer than half a second.
std::optional<SE3> pose_at(const PoseTrajectory& trajectory, double t) {
  constexpr double kHole = 0.5;  // [s], as for differentiated velocities
  const std::vector<StampedPose>& poses = trajectory.poses();
  const auto right = std::ranges::lower_bound(poses, t, {}, &StampedPose::t);
  if (right != poses.end() && right != poses.begin() && right->t > t && right->t - std::prev(right)->t > kHole) {
    return std::nullopt;
  }
  return trajectory.pose(t);
}

}  // namespace

PoseSamples sample_poses(const RunEstimate& estimate, const Similarity& alignment, double time_offset,
                         std::span<const double> times, bool velocity) {
  PoseSamples result;
  result.own_velocity = !estimate.velocities.empty();
  for (const double time : times) {
    const double t = time - time_offset;
    const std::optional<SE3> T = pose_at(estimate.poses, t);
    std::optional<Vector6> moving;
    if (T && velocity) moving = result.own_velocity ? estimate.velocities.at(t) : differentiate(estimate.poses, t);
    if (!T || (velocity && !moving)) {
      ++result.left_out;
      continue;
    }
    const auto [q, p] = alignment * *T;
    result.text += fmt::format("{} {} {} {} {} {} {} {}", time, p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w());
    if (moving) {
      const Vector3 v = alignment.scale * moving->tail<3>();
      result.text += fmt::format(" {} {} {}", v.x(), v.y(), v.z());
    }
    result.text += '\n';
  }
  return result;
}

}  // namespace evbench
