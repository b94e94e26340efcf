#include "bench/pipeline/covariance_samples.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace evbench {
namespace {

constexpr double kSampleInterval = 0.1;     // [s] between two newest poses
constexpr std::size_t kRelativePoses = 50;  // over each span, at most: each costs time that grows with the run

struct Span {
  const char* kind;
  double length;  // [s]
};
constexpr Span kSpans[] = {{"over_100ms", 0.1}, {"over_1s", 1.0}};

/// The pose nearest to `length` after pose i; null if it is off by more than half of that.
const StampedPose* later(const std::vector<StampedPose>& poses, std::size_t i, double length) {
  const double t = poses[i].t + length;
  const auto right = std::ranges::lower_bound(poses, t, {}, &StampedPose::t);
  const auto nearer = right == poses.end() || (t - (right - 1)->t < right->t - t) ? right - 1 : right;
  return std::abs(nearer->t - t) <= 0.5 * length && nearer->t > poses[i].t ? &*nearer : nullptr;
}

}  // namespace

void CovarianceSamples::take(const StampedPose& newest, BackEnd& backend) {
  if (newest.t < sampled_ + kSampleInterval) return;
  sampled_ = newest.t;
  const std::optional<Matrix12> covariance = backend.covariance(newest.t);
  if (covariance) newest_.push_back({newest, covariance->topLeftCorner<6, 6>()});
}

std::vector<RelativePose> CovarianceSamples::finish(BackEnd& backend) const {
  std::vector<RelativePose> result;
  const PoseTrajectory trajectory = backend.trajectory();
  if (trajectory.empty()) return result;
  const std::vector<StampedPose>& poses = trajectory.poses();
  const StampedPose& first = poses.front();
  for (const auto& [pose, covariance] : newest_) {
    result.push_back({"newest", first.t, pose.t, first.T.inverse() * pose.T, covariance});
  }
  for (const auto& [kind, length] : kSpans) {
    const std::size_t count = std::min(kRelativePoses, poses.size());
    for (std::size_t n = 0; n < count; ++n) {
      const std::size_t i = n * poses.size() / count;
      const StampedPose* const to = later(poses, i, length);
      if (to == nullptr) continue;
      const std::optional<Matrix6> covariance = backend.relative_covariance(poses[i].t, to->t);
      if (covariance) result.push_back({kind, poses[i].t, to->t, poses[i].T.inverse() * to->T, *covariance});
    }
  }
  return result;
}

}  // namespace evbench
