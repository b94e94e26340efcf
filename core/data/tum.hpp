#pragma once

#include <string>

#include "core/motion/pose_trajectory.hpp"

namespace evbench {

/// TUM trajectories, `t px py pz qx qy qz qw` a line: T_world_camera, seconds, metres, Hamilton quaternion. The
/// Event-Camera Dataset's groundtruth.txt is the same.

/// A file that is known to be one, as evbench writes it: read_poses() without its remarks.
PoseTrajectory read_tum(const std::string& path);

/// 9 decimals for time, more where it takes them to read back the same time; 10 for positions, 12 for quaternions: read
/// back, a pose differs by less than 1e-10.
std::string format_tum(const PoseTrajectory& trajectory);

}  // namespace evbench
