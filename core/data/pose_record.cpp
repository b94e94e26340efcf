#include "core/data/pose_record.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>

#include "core/geometry/nearest_rotation.hpp"
#include "core/geometry/types.hpp"

namespace evbench {
namespace {

constexpr double kTolerance = 1e-2;  // allows for rounded files; a larger deviation is no rotation

}  // namespace

Eigen::Quaterniond read_quaternion(const TextReader& reader, std::span<const std::size_t> columns) {
  const double x = reader.number(columns[0], "qx"), y = reader.number(columns[1], "qy");
  const double z = reader.number(columns[2], "qz"), w = reader.number(columns[3], "qw");
  const Eigen::Quaterniond q(w, x, y, z);
  const double norm = q.norm();
  if (!(std::abs(norm - 1.0) <= kTolerance)) {
    reader.fail(
        fmt::format("the quaternion ({} {} {} {}) has norm {:.6g}; expected 1 (qx qy qz qw)", x, y, z, w, norm));
  }
  return q.normalized();
}

Eigen::Quaterniond read_rotation_matrix(const TextReader& reader, std::span<const std::size_t> columns) {
  Matrix3 m;
  for (std::size_t i = 0; i < 9; ++i) {
    m(static_cast<Eigen::Index>(i / 3), static_cast<Eigen::Index>(i % 3)) =
        reader.number(columns[i], "an element of the rotation");
  }
  const double error = (m * m.transpose() - Matrix3::Identity()).cwiseAbs().maxCoeff();
  if (!(error <= kTolerance)) {
    reader.fail(
        fmt::format("the matrix r11 ... r33 is not a rotation: R Rᵀ is {:.3g} from the identity; "
                    "expected at most {}",
                    error, kTolerance));
  }
  if (m.determinant() < 0.0) reader.fail("the matrix r11 ... r33 is a reflection; expected a rotation (det R = 1)");
  return Eigen::Quaterniond(nearest_rotation(m).R).normalized();
}

Vector3 read_vector3(const TextReader& reader, std::span<const std::size_t> columns, const char* what) {
  return {reader.number(columns[0], what), reader.number(columns[1], what), reader.number(columns[2], what)};
}

}  // namespace evbench
