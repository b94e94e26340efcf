#pragma once

#include <string>

#include "core/motion/pose_trajectory.hpp"

namespace evbench {

/// Writes RobotEvt ground truth, `t r11 r12 r13 r21 r22 r23 r31 r32 r33 t1 t2 t3` per line: T_world_camera, rotation
/// row by row, seconds, metres. read_poses() reads it. 9 decimals for time, 10 for positions, 12 for rotations.
std::string format_robotevt(const PoseTrajectory& trajectory);

}  // namespace evbench
