#include "eval/velocity_error.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "eval/quantile.hpp"

namespace evbench {
namespace {

constexpr double kWindow = 0.05;   // [s] to each side
constexpr double kFarthest = 0.5;  // [s] of the poses that are used
constexpr int kThresholdCount = 500;

RelativeVelocityError relative_error(std::vector<std::pair<double, double>> errors_and_speeds) {
  std::erase_if(errors_and_speeds, [](const auto& one) { return !(one.second > 0.0); });
  if (errors_and_speeds.empty()) return {};
  std::ranges::sort(errors_and_speeds);
  double all = 0.0;
  std::vector<double> errors;
  for (const auto& [error, speed] : errors_and_speeds) {
    all += speed;
    errors.push_back(error);
  }
  double area = 0.0, below = 0.0, last = 0.0;
  auto next = errors_and_speeds.begin();
  for (int k = 0; k < kThresholdCount; ++k) {
    const double threshold = k / (kThresholdCount - 1.0);
    for (; next != errors_and_speeds.end() && next->first < threshold; ++next) below += next->second;
    const double share = below / all;
    if (k > 0) area += 0.5 * (last + share) / (kThresholdCount - 1.0);
    last = share;
  }
  return {area, quantile_of(errors, 0.5)};
}

}  // namespace

std::optional<Vector6> differentiate(const PoseTrajectory& trajectory, double t) {
  const std::vector<StampedPose>& poses = trajectory.poses();
  const std::optional<SE3> T = trajectory.empty() ? std::nullopt : trajectory.pose(t);
  if (!T) return std::nullopt;
  const auto at_or_after = std::ranges::lower_bound(poses, t, {}, &StampedPose::t);
  const auto after = std::ranges::upper_bound(poses, t, {}, &StampedPose::t);
  if (at_or_after - poses.begin() < 2 || poses.end() - after < 2) return std::nullopt;
  const auto first = std::min(std::ranges::lower_bound(poses, t - kWindow, {}, &StampedPose::t), at_or_after - 2);
  const auto last = std::max(std::ranges::upper_bound(poses, t + kWindow, {}, &StampedPose::t), after + 2);
  if (t - first->t > kFarthest || std::prev(last)->t - t > kFarthest) return std::nullopt;
  const Eigen::Index n = last - first;
  Eigen::MatrixXd powers(n, 4);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double tau = (first[i].t - t) / kWindow;  // well-conditioned
    powers.row(i) << 1.0, tau, tau * tau, tau * tau * tau;
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> solver(powers);
  Eigen::Matrix<double, Eigen::Dynamic, 6> increments(n, 6);
  Eigen::Matrix<double, 4, 6> cubic;
  SE3 base = *T;
  for (int round = 0; round < 2; ++round) {  // the second about the first one's pose: the interpolated one is off
    const SE3 inverse = base.inverse();
    for (Eigen::Index i = 0; i < n; ++i) increments.row(i) = se3::log(inverse * first[i].T).transpose();
    cubic = solver.solve(increments);
    base = base * se3::exp(cubic.row(0).transpose());
  }
  return Vector6(cubic.row(1).transpose() / kWindow);
}

VelocityErrors velocity_errors(std::span<const VelocityPair> pairs) {
  std::vector<std::pair<double, double>> linear, angular;
  const auto add = [](const Vector3& truth, const Vector3& estimate, auto& errors) {
    const double speed = truth.norm();
    errors.emplace_back((truth - estimate).norm() / speed, speed);
  };
  for (const VelocityPair& pair : pairs) {
    add(pair.ground_truth.head<3>(), pair.estimate.head<3>(), angular);
    add(pair.ground_truth.tail<3>(), pair.estimate.tail<3>(), linear);
  }
  return {relative_error(std::move(linear)), relative_error(std::move(angular)), pairs.size()};
}

}  // namespace evbench
