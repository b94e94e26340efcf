#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/geometry/se3.hpp"

namespace evbench {

struct StampedPose {
  double t = 0.0;  ///< [s]
  SE3 T;           ///< T_world_camera
};

/// Interpolates between two poses: position linearly, rotation by slerp.
SE3 interpolate(const StampedPose& left, const StampedPose& right, double t);

/// A discrete trajectory: poses at strictly increasing times.
class PoseTrajectory {
 public:
  PoseTrajectory() = default;

  /// Throws InputError if the stamps are not strictly increasing; `name` names the trajectory in the message.
  explicit PoseTrajectory(std::vector<StampedPose> poses, const std::string& name = "trajectory");

  const std::vector<StampedPose>& poses() const& { return poses_; }
  std::vector<StampedPose> poses() && { return std::move(poses_); }
  bool empty() const { return poses_.empty(); }
  std::size_t size() const { return poses_.size(); }
  double start() const { return poses_.front().t; }  ///< [s]; the trajectory must not be empty
  double end() const { return poses_.back().t; }     ///< [s]; the trajectory must not be empty

  /// Pose at t, interpolated between its neighbours; none outside [start, end].
  std::optional<SE3> pose(double t) const;

  /// The poses with from ≤ t ≤ to.
  PoseTrajectory cut(double from, double to) const;

  /// Sum of the distances between consecutive positions [m].
  double path_length() const;

 private:
  std::vector<StampedPose> poses_;
};

}  // namespace evbench
