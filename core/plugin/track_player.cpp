#include "core/plugin/track_player.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

namespace evbench {

TrackPlayer::TrackPlayer(std::span<const TrackObservation> observations, std::vector<TrackEnd> ends)
    : observations_(observations), ends_(std::move(ends)) {
  std::map<TrackId, double> first, last;
  for (const TrackObservation& z : observations) {
    first.try_emplace(z.track, z.t);
    last[z.track] = z.t;
  }
  std::erase_if(ends_, [&](const TrackEnd& end) {
    const auto begin = first.find(end.track);
    return begin == first.end() || end.t < begin->second;
  });
  std::set<TrackId> closed;
  for (const TrackEnd& end : ends_) {
    if (end.t >= last.at(end.track)) closed.insert(end.track);
  }
  for (const auto& [track, t] : last) {
    if (!closed.contains(track)) ends_.push_back({track, t});
  }
  std::ranges::stable_sort(ends_, {}, &TrackEnd::t);
}

bool TrackPlayer::advance(const FrontEnd::Horizon& horizon, TrackBatch& batch) {
  batch.until = horizon.t;
  if (horizon.observations > 0 && next_ + horizon.observations <= observations_.size()) {
    batch.until = std::min(batch.until, observations_[next_ + horizon.observations - 1].t);
  }
  const auto left = observations_.subspan(next_);
  const auto last = std::ranges::upper_bound(left, batch.until, {}, &TrackObservation::t);
  batch.observations.assign(left.begin(), last);
  next_ += batch.observations.size();
  batch.ended.clear();
  while (next_end_ < ends_.size() && ends_[next_end_].t <= batch.until) batch.ended.push_back(ends_[next_end_++]);
  return next_ < observations_.size() || next_end_ < ends_.size();
}

}  // namespace evbench
