#pragma once

#include <array>
#include <numeric>
#include <span>

#include "core/geometry/se3.hpp"
#include "core/io/text_reader.hpp"

namespace evbench {

/// Reads the parts of a pose from the columns of a record. Every error names file and line.

/// The column `first` and the following ones, `count` in all.
template <std::size_t count>
std::array<std::size_t, count> consecutive(std::size_t first) {
  std::array<std::size_t, count> columns;
  std::iota(columns.begin(), columns.end(), first);
  return columns;
}

/// Reads and normalises a quaternion from the columns of qx qy qz qw. Throws when the norm is not within 1e-2 of 1.
Eigen::Quaterniond read_quaternion(const TextReader& reader, std::span<const std::size_t> columns);

/// Reads a rotation matrix from its columns, row by row, and returns the nearest rotation (Frobenius norm, by SVD).
/// Throws when R Rᵀ is not within 1e-2 of the identity or det R < 0.
Eigen::Quaterniond read_rotation_matrix(const TextReader& reader, std::span<const std::size_t> columns);

/// Reads a vector; `what` names it in messages.
Vector3 read_vector3(const TextReader& reader, std::span<const std::size_t> columns, const char* what);

}  // namespace evbench
