#pragma once

#include <array>
#include <numeric>
#include <span>

#include "core/geometry/se3.hpp"
#include "core/io/text_reader.hpp"

namespace evbench {

/// Parts of a pose in the columns of a record. Every error names the file and the line.

/// `first` and those behind it.
template <std::size_t count>
std::array<std::size_t, count> consecutive(std::size_t first) {
  std::array<std::size_t, count> columns;
  std::iota(columns.begin(), columns.end(), first);
  return columns;
}

/// Columns of qx qy qz qw. Throws when the norm is not within 1e-2 of 1; normalised.
Eigen::Quaterniond read_quaternion(const TextReader& reader, std::span<const std::size_t> columns);

/// Columns of a rotation matrix, row by row. Throws when R Rᵀ is not within 1e-2 of the identity or det R < 0; the
/// nearest rotation (Frobenius norm, by SVD) is returned.
Eigen::Quaterniond read_rotation_matrix(const TextReader& reader, std::span<const std::size_t> columns);

/// `what` names it in messages.
Vector3 read_vector3(const TextReader& reader, std::span<const std::size_t> columns, const char* what);

}  // namespace evbench
