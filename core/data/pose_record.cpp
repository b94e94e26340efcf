#include "core/data/pose_record.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>

#include "core/support/error.hpp"

namespace evbench {
namespace {

constexpr double kTolerance = 1e-2;  // files carry few digits; anything worse is not a rotation

}  // namespace

Eigen::Quaterniond read_quaternion(const TextReader& reader, std::size_t first) {
  const double x = reader.number(first, "qx"), y = reader.number(first + 1, "qy");
  const double z = reader.number(first + 2, "qz"), w = reader.number(first + 3, "qw");
  const Eigen::Quaterniond q(w, x, y, z);
  const double norm = q.norm();
  if (!(std::abs(norm - 1.0) <= kTolerance)) {
    reader.fail(
        fmt::format("the quaternion ({} {} {} {}) has norm {:.6g}; expected 1 (qx qy qz qw)", x, y, z, w, norm));
  }
  return q.normalized();
}

Eigen::Quaterniond read_rotation_matrix(const TextReader& reader, std::size_t first) {
  Matrix3 m;
  for (std::size_t i = 0; i < 9; ++i) {
    m(static_cast<Eigen::Index>(i / 3), static_cast<Eigen::Index>(i % 3)) =
        reader.number(first + i, "an element of the rotation");
  }
  const double error = (m * m.transpose() - Matrix3::Identity()).cwiseAbs().maxCoeff();
  if (!(error <= kTolerance)) {
    reader.fail(
        fmt::format("the matrix r11 ... r33 is not a rotation: R Rᵀ is {:.3g} from the identity; "
                    "expected at most {}",
                    error, kTolerance));
  }
  if (m.determinant() < 0.0) reader.fail("the matrix r11 ... r33 is a reflection; expected a rotation (det R = 1)");
  const Eigen::JacobiSVD<Matrix3> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return Eigen::Quaterniond(svd.matrixU() * svd.matrixV().transpose()).normalized();
}

Vector3 read_vector3(const TextReader& reader, std::size_t first, const char* what) {
  return {reader.number(first, what), reader.number(first + 1, what), reader.number(first + 2, what)};
}

void append_pose(const TextReader& reader, const StampedPose& pose, std::vector<StampedPose>& poses) {
  if (!poses.empty() && !(poses.back().t < pose.t)) {
    reader.fail(fmt::format("time {:.9f} s is {} the one before it ({:.9f} s); expected strictly increasing times",
                            pose.t, poses.back().t == pose.t ? "the same as" : "before", poses.back().t));
  }
  poses.push_back(pose);
}

void expect_poses(const std::vector<StampedPose>& poses, const std::string& path) {
  if (poses.empty()) throw InputError(fmt::format("{}: holds no pose; expected at least one", path));
}

}  // namespace evbench
