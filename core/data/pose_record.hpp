#pragma once

#include <vector>

#include "core/io/text_reader.hpp"
#include "core/motion/pose_trajectory.hpp"

namespace evbench {

/// What the pose formats share: the checks of a record's rotation and time. Every error names the file and the line.

/// Columns `first` to `first` + 3 as a quaternion qx qy qz qw. Throws when its norm is not within 1e-2 of 1;
/// normalised.
Eigen::Quaterniond read_quaternion(const TextReader& reader, std::size_t first);

/// Columns `first` to `first` + 8 as a rotation matrix, row by row. Throws when R Rᵀ is not within 1e-2 of the identity
/// or det R < 0; the nearest rotation (Frobenius norm, by SVD) is returned.
Eigen::Quaterniond read_rotation_matrix(const TextReader& reader, std::size_t first);

/// Columns `first` to `first` + 2.
Vector3 read_vector3(const TextReader& reader, std::size_t first, const char* what);

/// Appends a pose; throws when it is not later than the last one.
void append_pose(const TextReader& reader, const StampedPose& pose, std::vector<StampedPose>& poses);

/// Throws unless there is at least one pose; for the end of the file `path`.
void expect_poses(const std::vector<StampedPose>& poses, const std::string& path);

}  // namespace evbench
