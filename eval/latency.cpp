#include "eval/latency.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <vector>

namespace evbench {
namespace {

constexpr double kLongestPrediction = 1.0;  // [s]
constexpr double kVelocityBase = 0.02;      // [s]: for closer poses noise would dominate the velocity
constexpr double kRounding = 1e-9;          // [s]

using KnownPoses = std::map<double, const CausalPose*>;  // by time, the last one published

Vector6 velocity_of(const CausalPose& newest, const KnownPoses& known) {
  if (newest.velocity) return *newest.velocity;
  auto older = known.upper_bound(newest.t - kVelocityBase);
  if (older != known.begin()) --older;
  const double dt = newest.t - older->first;
  return dt > 0.0 ? Vector6(se3::log(older->second->T.inverse() * newest.T) / dt) : Vector6(Vector6::Zero());
}

std::optional<SE3> estimate(const KnownPoses& known, double t) {
  const auto right = known.lower_bound(t);
  if (right == known.end()) {
    if (known.empty() || t - known.rbegin()->first > kLongestPrediction) return std::nullopt;
    const CausalPose& newest = *known.rbegin()->second;
    return newest.T * se3::exp((t - newest.t) * velocity_of(newest, known));
  }
  if (right->first == t) return right->second->T;
  if (right == known.begin()) return std::nullopt;
  return interpolate(*std::prev(right)->second, *right->second, t);
}

}  // namespace

std::optional<Delay> delay_of(std::span<const CausalPose> published) {
  std::vector<double> delays;
  double newest = -std::numeric_limits<double>::infinity();
  for (const CausalPose& pose : published) {
    if (pose.t <= newest) continue;
    newest = pose.t;
    delays.push_back(pose.known_at.value_or(pose.t) - pose.t);
  }
  if (delays.empty()) return std::nullopt;
  std::ranges::sort(delays);
  return Delay{delays[delays.size() / 2], delays[delays.size() * 99 / 100], delays.back()};
}

PoseTrajectory estimates_at_latency(std::span<const CausalPose> published, std::span<const double> times,
                                    double latency) {
  KnownPoses known;
  std::vector<StampedPose> poses;
  auto next = published.begin();
  for (const double t : times) {
    for (; next != published.end() && *next->known_at <= t + latency + kRounding; ++next) known[next->t] = &*next;
    if (const std::optional<SE3> T = estimate(known, t)) poses.push_back({t, *T});
  }
  return PoseTrajectory(std::move(poses), "the estimate at a latency");
}

}  // namespace evbench
