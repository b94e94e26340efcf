#pragma once

#include <string>
#include <vector>

#include "core/motion/pose_trajectory.hpp"

namespace evbench::hdf5 {

/// Poses of a file as 4x4 matrices, row by row; their times are in another data set in units of `unit` seconds. Throws
/// InputError, naming file and data set, for missing data sets, for invalid poses, and for a file on which the library
/// crashes.
std::vector<StampedPose> read_poses(const std::string& path, const std::string& matrices, const std::string& times,
                                    double unit);

/// One such matrix. Throws likewise.
SE3 read_pose(const std::string& path, const std::string& matrix);

}  // namespace evbench::hdf5
