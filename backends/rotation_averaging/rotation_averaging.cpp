#include "backends/rotation_averaging/rotation_averaging.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/geometry/so3.hpp"
#include "core/plugin/registration.hpp"

namespace evbench {
namespace {

const Registration<BackEnd, RotationAveraging> registration(
    "rotation_averaging", "rotation-only odometry: averages the relative rotations of tracks");

}  // namespace

void RotationAveraging::Options::declare(OptionSet& set) {
  set.add("interval", interval, "time between two rotations [s]").range(1e-3, 1.0);
  set.add("reach", reach, "pairs of rotations are 1, 2, 4, ... intervals apart, at most this many").range(1, 10'000);
  set.add("least_tracks", least_tracks, "tracks that both times of a pair have in common, at least").range(3);
  set.add("robust_scale", robust_scale, "distance from its rotated direction at which a track has half the weight [px]")
      .above(0.0);
  set.add("longest_gap", longest_gap,
          "a track is not interpolated between observations farther apart; rotations are late by this time [s]")
      .above(0.0);
}

RotationAveraging::RotationAveraging(const Options& options, const BackEndContext& context)
    : options_(options), context_(context), monitor_(context.patience) {}

void RotationAveraging::advance(const UndistortedBatch& batch) {
  const auto begin = std::chrono::steady_clock::now();
  if (monitor_.lost()) return;
  in_time_order(
      batch.observations, batch.ended, [&](const UndistortedObservation& z) { take(z); },
      [&](const TrackEnd& ended) { last_.erase(ended.track); });
  until_ = batch.until;
  while (start_ && !monitor_.lost() && time_of(rotations_.size()) + options_.longest_gap <= until_) {
    const std::size_t before = rotations_.size();
    close_sample();
    if (rotations_.size() == before) continue;
    context_.publish({{time_of(before), {rotations_.back(), Vector3::Zero()}}, batch.until, {}});
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  updates_.push_back({.t = until_,
                      .seconds = seconds,
                      .states = static_cast<int>(rotations_.size()),
                      .landmarks = static_cast<int>(last_.size()),
                      .observations = static_cast<int>(batch.observations.size()),
                      .iterations = 0,
                      .cost = std::nullopt});
}

/// Interpolates the directions at the samples between the track's last observation and this one.
void RotationAveraging::take(const UndistortedObservation& z) {
  if (!start_) start_ = z.t;
  const auto [found, fresh] = last_.try_emplace(z.track, z);
  if (fresh) return;
  const UndistortedObservation before = std::exchange(found->second, z);
  if (!(z.t > before.t) || z.t - before.t > options_.longest_gap) return;
  const auto next = [&](double t) {
    return static_cast<std::size_t>(std::max(0.0, std::ceil((t - *start_) / options_.interval)));
  };
  for (std::size_t k = std::max(next(before.t), rotations_.size()); time_of(k) < z.t; ++k) {
    while (first_ + samples_.size() <= k) samples_.push_back({time_of(first_ + samples_.size())});
    const double part = (time_of(k) - before.t) / (z.t - before.t);
    const Vector2 pixel = before.pixel + part * (z.pixel - before.pixel);
    if (!pixel.allFinite()) continue;
    samples_[k - first_].directions[z.track] = context_.camera.ray(pixel).normalized();
  }
}

/// Closes the next sample: adds its pairs with earlier ones, and its rotation from these. The first sample is the first
/// one with enough tracks.
void RotationAveraging::close_sample() {
  const std::size_t k = rotations_.size();
  while (first_ + samples_.size() <= k) samples_.push_back({time_of(first_ + samples_.size())});
  const Sample& sample = samples_[k - first_];
  if (k == 0 && sample.directions.size() < static_cast<std::size_t>(options_.least_tracks)) {
    samples_.pop_front();
    *start_ += options_.interval;
    return;
  }
  const double pixel = 1.0 / context_.camera.fx;  // [rad]
  std::vector<std::pair<Vector3, Vector3>> pairs;
  Vector3 mean = Vector3::Zero();
  double weights = 0.0;
  const Eigen::Quaterniond last = k == 0 ? Eigen::Quaterniond::Identity() : rotations_.back();
  for (std::size_t span = 1; span <= static_cast<std::size_t>(options_.reach) && span <= k - first_; span *= 2) {
    pairs.clear();
    const Sample& other = samples_[k - span - first_];
    for (const auto& [track, direction] : sample.directions) {
      if (const auto there = other.directions.find(track); there != other.directions.end()) {
        pairs.emplace_back(there->second, direction);
      }
    }
    if (pairs.size() < static_cast<std::size_t>(options_.least_tracks)) continue;
    const auto found = align_directions(pairs, options_.robust_scale * pixel);
    if (!found) continue;
    const double variance = (found->residual * found->residual + 0.01 * pixel * pixel) / found->weight;
    edges_.push_back({k - span, k, found->R, 1.0 / variance});
    const Vector3 change = so3::log((last.conjugate() * rotations_[k - span] * found->R).normalized());
    mean += change / variance;
    weights += 1.0 / variance;
  }
  if (k == 0) {
    rotations_.push_back(Eigen::Quaterniond::Identity());
  } else {
    monitor_.observe(time_of(k - 1), time_of(k),
                     weights > 0.0 ? TrackingMonitor::Support::full : TrackingMonitor::Support::none,
                     fmt::format("fewer than {} tracks in common with an earlier time", options_.least_tracks));
    rotations_.push_back(weights > 0.0 ? (last * so3::exp(mean / weights)).normalized() : last);
  }
  while (first_ + static_cast<std::size_t>(options_.reach) < k) {
    samples_.pop_front();
    ++first_;
  }
}

BackEndFeedback RotationAveraging::feedback(const FeedbackNeeds&) {
  BackEndFeedback result;
  result.state = monitor_.state();
  if (rotations_.size() < 2) return result;
  const std::size_t k = rotations_.size() - 1;
  Vector6 velocity = Vector6::Zero();
  velocity.head<3>() = so3::log((rotations_[k - 1].conjugate() * rotations_[k]).normalized()) / options_.interval;
  result.newest = ControlState{time_of(k), {rotations_[k], Vector3::Zero()}, velocity};
  return result;
}

void RotationAveraging::finish() {
  const auto has_tracks = [&](std::size_t sample) {
    return sample < first_ + samples_.size() &&
           samples_[sample - first_].directions.size() >= static_cast<std::size_t>(options_.least_tracks);
  };
  while (!monitor_.lost() && has_tracks(rotations_.size())) close_sample();
  if (rotations_.size() < 2) {
    if (!monitor_.lost()) monitor_.fail(until_, "no two times have enough tracks in common");
    return;
  }
  average_rotations(edges_, options_.robust_scale / context_.camera.fx, rotations_);
}

PoseTrajectory RotationAveraging::trajectory() const {
  std::vector<StampedPose> poses;
  for (std::size_t k = 0; k < rotations_.size() && rotations_.size() > 1; ++k) {
    poses.push_back({time_of(k), {rotations_[k], Vector3::Zero()}});
  }
  return PoseTrajectory(std::move(poses), "rotation averaging");
}

}  // namespace evbench
