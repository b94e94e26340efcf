#include "bench/pipeline/stationary_detector.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace evbench {
namespace {

constexpr std::size_t kEnough = 6;  ///< tracks: fewer say little of the camera
constexpr double kStandstillInterval =
    0.02;                        ///< [s] between two times at which the tracks are held: as often as slow trackers tell
constexpr double kSigma = 0.5;   ///< [px] at least: a tracker's next step may be about to come
constexpr double kStep = 1.5;    ///< [px] that a tracker may have moved when it tells that there is motion again
constexpr double kLong = 4.0;    ///< times the usual time between observations: a silence
constexpr double kSoon = 0.1;    ///< [s] from the end of a silence: what it was is seen
constexpr double kMemory = 1.0;  ///< [s] in which what is usual is forgotten

}  // namespace

void StationaryDetector::apply(TrackBatch& batch) {
  if (refuted_) std::erase_if(spans_, [&](const StationaryPeriod& span) { return span.from == refuted_->span.from; });
  refuted_.reset();
  if (after_ == 0.0) return;
  const std::vector<TrackObservation> seen = std::move(batch.observations);
  batch.observations.clear();
  const auto observe = [&](const TrackObservation& z) {
    hold(z.t, batch.observations);  // silence within a long batch, too
    batch.observations.push_back(z);
    remember(z);
  };
  const auto end = [&](const TrackEnd& ended) {
    hold(ended.t, batch.observations);
    forget(ended);
  };
  in_time_order(seen, batch.ended, observe, end);
  hold(batch.until, batch.observations);
}

void StationaryDetector::remember(const TrackObservation& z) {
  const double gap = z.t - last_;
  const auto known = live_.find(z.track);
  const bool jumped = known != live_.end() && (z.pixel - known->second.pixel).norm() > kStep;
  // What moved on unseen did not stand still: the tracker is a slow one.
  if (!live_.empty() && (!still_ || jumped)) usual_ = std::max(gap, usual_ * std::exp(-gap / kMemory));
  live_[z.track] = z;
  last_ = z.t;
  held_ = 0;
  still_ = false;
  if (seen_again_ || stood_ == 0) return;
  seen_again_ = z.t;
  std::erase_if(gone_at_, [&](double t) { return z.t - t > kSoon; });  // they ended while nothing was seen
  doubt();
}

void StationaryDetector::forget(const TrackEnd& ended) {
  live_.erase(ended.track);
  if (held_tracks_.erase(ended.track) == 0 || (seen_again_ && ended.t > *seen_again_ + kSoon)) return;
  gone_at_.push_back(ended.t);
  doubt();
}

/// Has the camera moved while nothing was told?
void StationaryDetector::doubt() {
  if (2 * gone_at_.size() <= stood_ || !seen_again_) return;
  refuted_ = {refuted_ ? refuted_->span : spans_.back(), std::exchange(held_tracks_, {})};
  stood_ = 0;
  gone_at_.clear();
}

void StationaryDetector::begin_stand(double t) {
  spans_.push_back({last_, t});
  still_ = true;
  seen_again_.reset();
  held_tracks_.clear();
  for (const auto& [track, z] : live_) held_tracks_.insert(track);
  stood_ = live_.size();
  gone_at_.clear();
}

/// Adds what the silence from the last observation up to `until` says.
void StationaryDetector::hold(double until, std::vector<TrackObservation>& observations) {
  if (live_.size() < kEnough) {
    still_ = false;
    return;
  }
  const double first = last_ + std::max(after_, kLong * usual_);
  for (double t = 0.0; (t = first + kStandstillInterval * static_cast<double>(held_)) <= until; ++held_) {
    if (!still_) begin_stand(t);
    spans_.back().to = t;
    for (const auto& [track, z] : live_) {
      observations.push_back({track, t, z.pixel, std::max(z.sigma, kSigma)});
    }
  }
}

}  // namespace evbench
