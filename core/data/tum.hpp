#pragma once

#include <string>

#include "core/motion/pose_trajectory.hpp"

namespace evbench {

/// TUM trajectories, `t px py pz qx qy qz qw` per line: T_world_camera, seconds, metres, Hamilton quaternion. The
/// Event-Camera Dataset's groundtruth.txt is the same.

/// Reads a file that is known to be in TUM format, such as evbench's own: read_poses() without remarks.
PoseTrajectory read_tum(const std::string& path);

/// Writes 9 decimals for time (more if needed to read back the same time), 10 for positions and 12 for quaternions: a
/// pose read back differs by less than 1e-10.
std::string format_tum(const PoseTrajectory& trajectory);

}  // namespace evbench
