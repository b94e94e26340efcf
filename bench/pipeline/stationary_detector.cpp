#include "bench/pipeline/stationary_detector.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace evbench {
namespace {

constexpr std::size_t kEnough = 6;        ///< tracks: fewer are no evidence of a stationary camera
constexpr double kRepeatInterval = 0.02;  ///< [s] between two repetitions of the tracks: the rate of a slow tracker
constexpr double kSigma = 0.5;            ///< [px] at least: a tracker's next step may be about to come
constexpr double kStep = 1.5;             ///< [px] that a tracker may move before it reports that motion has resumed
constexpr double kLong = 4.0;             ///< usual intervals without an observation, at least, in a stationary period
constexpr double kSoon = 0.1;             ///< [s] from the end of a period: ends of tracks in this time are evidence
constexpr double kMemory = 1.0;           ///< [s] time constant with which the usual interval decays

}  // namespace

void StationaryDetector::apply(UndistortedBatch& batch) {
  if (rejected_)
    std::erase_if(periods_, [&](const StationaryPeriod& period) { return period.from == rejected_->period.from; });
  rejected_.reset();
  if (after_ == 0.0) return;
  const std::vector<UndistortedObservation> seen = std::move(batch.observations);
  batch.observations.clear();
  const auto observe = [&](const UndistortedObservation& z) {
    repeat_tracks(z.t, batch.observations);  // a period may also lie within a long batch
    batch.observations.push_back(z);
    on_observation(z);
  };
  const auto end = [&](const TrackEnd& ended) {
    repeat_tracks(ended.t, batch.observations);
    on_end(ended);
  };
  in_time_order(seen, batch.ended, observe, end);
  repeat_tracks(batch.until, batch.observations);
}

void StationaryDetector::on_observation(const UndistortedObservation& z) {
  const double gap = z.t - last_;
  const auto known = live_.find(z.track);
  const bool jumped = known != live_.end() && (z.pixel - known->second.pixel).norm() > kStep;
  // A track that jumped has moved between its observations: the tracker is slow, the camera was not stationary.
  if (!live_.empty() && (!is_stationary_ || jumped))
    usual_interval_ = std::max(gap, usual_interval_ * std::exp(-gap / kMemory));
  live_[z.track] = z;
  last_ = z.t;
  repetitions_ = 0;
  is_stationary_ = false;
  if (seen_again_ || repeated_count_ == 0) return;
  seen_again_ = z.t;
  std::erase_if(ended_at_, [&](double t) { return z.t - t > kSoon; });  // ended during the period
  check_period();
}

void StationaryDetector::on_end(const TrackEnd& ended) {
  live_.erase(ended.track);
  if (repeated_tracks_.erase(ended.track) == 0 || (seen_again_ && ended.t > *seen_again_ + kSoon)) return;
  ended_at_.push_back(ended.t);
  check_period();
}

/// Rejects the last period if most of its tracks have ended.
void StationaryDetector::check_period() {
  if (2 * ended_at_.size() <= repeated_count_ || !seen_again_) return;
  rejected_ = {rejected_ ? rejected_->period : periods_.back(), std::exchange(repeated_tracks_, {})};
  repeated_count_ = 0;
  ended_at_.clear();
}

void StationaryDetector::begin_period(double t) {
  periods_.push_back({last_, t});
  is_stationary_ = true;
  seen_again_.reset();
  repeated_tracks_.clear();
  for (const auto& [track, z] : live_) repeated_tracks_.insert(track);
  repeated_count_ = live_.size();
  ended_at_.clear();
}

/// Repeats the tracks' last positions between the last observation and `until` if the camera is stationary there.
void StationaryDetector::repeat_tracks(double until, std::vector<UndistortedObservation>& observations) {
  if (live_.size() < kEnough) {
    is_stationary_ = false;
    return;
  }
  const double first = last_ + std::max(after_, kLong * usual_interval_);
  for (double t = 0.0; (t = first + kRepeatInterval * static_cast<double>(repetitions_)) <= until; ++repetitions_) {
    if (!is_stationary_) begin_period(t);
    periods_.back().to = t;
    for (const auto& [track, z] : live_) {
      observations.push_back({track, t, z.pixel, z.noise.sigma() < kSigma ? kSigma : z.noise});
    }
  }
}

}  // namespace evbench
