#pragma once

#include <string>

#include "core/motion/pose_trajectory.hpp"

namespace evbench {

/// RobotEvt ground truth, `t r11 r12 r13 r21 ... r33 t1 t2 t3` a line: T_world_camera, rotation row by row, seconds,
/// metres.

/// Throws InputError, naming file and line, for a wrong number of columns, a value that is not finite, a matrix that is
/// not a rotation to 1e-2 (the nearest rotation is taken), times that do not strictly increase, and a file without
/// poses.
PoseTrajectory read_robotevt(const std::string& path);

/// 9 decimals for time, 10 for positions, 12 for rotations.
std::string format_robotevt(const PoseTrajectory& trajectory);

}  // namespace evbench
