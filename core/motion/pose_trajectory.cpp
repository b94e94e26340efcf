#include "core/motion/pose_trajectory.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/support/error.hpp"

namespace evbench {

SE3 interpolate(const StampedPose& left, const StampedPose& right, double t) {
  const double s = (t - left.t) / (right.t - left.t);
  return {left.T.q.slerp(s, right.T.q), (1.0 - s) * left.T.p + s * right.T.p};
}

PoseTrajectory::PoseTrajectory(std::vector<StampedPose> poses, const std::string& name) : poses_(std::move(poses)) {
  for (std::size_t i = 1; i < poses_.size(); ++i) {
    if (!(poses_[i - 1].t < poses_[i].t)) {
      throw InputError(
          fmt::format("{}: pose {} has time {:.9f} s, not after the one before it ({:.9f} s); "
                      "expected strictly increasing times",
                      name, i + 1, poses_[i].t, poses_[i - 1].t));
    }
  }
}

std::optional<SE3> PoseTrajectory::pose(double t) const {
  if (poses_.empty() || t < start() || t > end()) return std::nullopt;
  const auto right =
      std::lower_bound(poses_.begin(), poses_.end(), t, [](const StampedPose& p, double time) { return p.t < time; });
  if (right->t == t) return right->T;
  return interpolate(*(right - 1), *right, t);
}

PoseTrajectory PoseTrajectory::cut(double from, double to) const {
  PoseTrajectory result;
  std::copy_if(poses_.begin(), poses_.end(), std::back_inserter(result.poses_),
               [&](const StampedPose& p) { return p.t >= from && p.t <= to; });
  return result;
}

double PoseTrajectory::path_length() const {
  double length = 0.0;
  for (std::size_t i = 1; i < poses_.size(); ++i) length += (poses_[i].T.p - poses_[i - 1].T.p).norm();
  return length;
}

}  // namespace evbench
