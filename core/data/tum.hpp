#pragma once

#include <string>

#include "core/motion/pose_trajectory.hpp"

namespace evbench {

/// TUM trajectories, `t px py pz qx qy qz qw` a line: T_world_camera, seconds, metres, Hamilton quaternion. The
/// Event-Camera Dataset's groundtruth.txt is the same.

/// `time_unit`: of the file's times [s]. Throws InputError, naming file and line, for a wrong number of columns, a
/// value that is not finite, a quaternion whose norm is not within 1e-2 of 1 (it is normalised), times that do not
/// strictly increase, and a file without poses.
PoseTrajectory read_tum(const std::string& path, double time_unit = 1.0);

/// 9 decimals for time, more where it takes them to read back the same time; 10 for positions, 12 for quaternions: read
/// back, a pose differs by less than 1e-10.
std::string format_tum(const PoseTrajectory& trajectory);

}  // namespace evbench
