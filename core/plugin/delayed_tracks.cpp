#include "core/plugin/delayed_tracks.hpp"

#include <algorithm>

namespace evbench {

void DelayedTracks::add(const TrackObservation& z) {
  waiting_.insert(std::ranges::upper_bound(waiting_, z.t, {}, &TrackObservation::t), z);
}

void DelayedTracks::take_back(TrackId track, double t) {
  std::erase_if(waiting_, [&](const TrackObservation& z) { return z.track == track && z.t > t; });
}

void DelayedTracks::release(double t, std::size_t most, TrackBatch& batch) {
  batch.until = std::max(until_, t);
  if (most > 0 && has(most, batch.until)) batch.until = waiting_[most - 1].t;
  batch.observations.clear();
  for (; !waiting_.empty() && waiting_.front().t <= batch.until; waiting_.pop_front()) {
    batch.observations.push_back(waiting_.front());
  }
  batch.ended.clear();
  for (; !ended_.empty() && ended_.front().t <= batch.until; ended_.pop_front()) batch.ended.push_back(ended_.front());
  until_ = batch.until;
}

}  // namespace evbench
