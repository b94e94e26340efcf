#include "eval/pose_error.hpp"

#include <cmath>

#include "core/geometry/so3.hpp"

namespace evbench {
namespace {

double angle_deg(const Eigen::Quaterniond& q) { return so3::log(q).norm() * kDegrees; }

}  // namespace

PoseErrors absolute_errors(std::span<const PosePair> pairs) {
  PoseErrors errors;
  for (const PosePair& pair : pairs) {
    errors.trans_m.push_back((pair.estimate.p - pair.ground_truth.p).norm());
    errors.rot_deg.push_back(angle_deg(pair.estimate.q.conjugate() * pair.ground_truth.q));
  }
  return errors;
}

double yaw_error_deg(const PosePair& pair) {
  const Matrix3 R = (pair.estimate.q * pair.ground_truth.q.conjugate()).toRotationMatrix();
  return std::abs(std::atan2(R(1, 0), R(0, 0))) * kDegrees;
}

PoseErrors relative_errors(std::span<const PosePair> pairs,
                           std::span<const std::pair<std::size_t, std::size_t>> indices) {
  PoseErrors errors;
  for (const auto& [i, j] : indices) {
    const SE3 truth = pairs[i].ground_truth.inverse() * pairs[j].ground_truth;
    const SE3 estimate = pairs[i].estimate.inverse() * pairs[j].estimate;
    errors.trans_m.push_back((estimate.p - truth.p).norm());
    errors.rot_deg.push_back(angle_deg(truth.q.conjugate() * estimate.q));
  }
  return errors;
}

}  // namespace evbench
