#include "backends/gp_map/track_table.hpp"

#include <algorithm>
#include <span>

#include "core/smoother/problem_graph.hpp"

namespace evbench::gp_map {

void TrackTable::receive(const UndistortedBatch& batch) {
  pending_.insert(pending_.end(), batch.observations.begin(), batch.observations.end());
  ending_.insert(ending_.end(), batch.ended.begin(), batch.ended.end());
  ended_landmarks_.clear();
}

void TrackTable::advance_to(double t, const std::function<void(const UndistortedObservation&)>& association) {
  const auto later = std::ranges::upper_bound(pending_, t, {}, &UndistortedObservation::t);
  const auto ending_later = std::ranges::upper_bound(ending_, t, {}, &TrackEnd::t);
  const auto end = [&](const TrackEnd& ended) {
    const auto track = tracks_.find(ended.track);
    if (track == tracks_.end()) return;
    track->second.ended = true;
    track->second.mismatched = false;
  };
  in_time_order(
      std::span(pending_.begin(), later), std::span(ending_.begin(), ending_later),
      [&](const UndistortedObservation& z) { take(z, association); }, end);
  pending_.erase(pending_.begin(), later);
  ending_.erase(ending_.begin(), ending_later);
}

void TrackTable::take(const UndistortedObservation& z,
                      const std::function<void(const UndistortedObservation&)>& association) {
  Track& track = tracks_[z.track];
  if (track.mismatched) return;
  live_.insert(z.track);
  if (track.role == Role::landmark) association(z);
  track.ended = false;
  if (track.role == Role::waiting) waiting_.add({&z, 1});
  if (!remembered_.empty()) remembered_.add({&z, 1});
  if (track.role == Role::landmark) new_observations_.emplace_back(track.landmark, to_observation(z, sigma_scale_));
}

void TrackTable::drop_ended(double t, bool has_map, double memory) {
  if (!has_map) waiting_.forget_ended_before(t - memory);
  std::erase_if(live_, [&](TrackId id) {
    const auto track = tracks_.find(id);
    if (!track->second.ended || (!has_map && !waiting_.observations(id).empty())) return false;
    if (track->second.role == Role::landmark) ended_landmarks_.push_back(id);
    if (track->second.role == Role::waiting) {
      waiting_.forget(id);
      tracks_.erase(track);
    }
    return true;
  });
}

const TrackTable::Track* TrackTable::find(TrackId id) const {
  const auto track = tracks_.find(id);
  return track == tracks_.end() ? nullptr : &track->second;
}

int TrackTable::landmarks_in_view() const {
  return static_cast<int>(std::ranges::count(live_, Role::landmark, [&](TrackId id) { return tracks_.at(id).role; }));
}

int TrackTable::mismatched() const {
  return static_cast<int>(std::ranges::count_if(live_, [&](TrackId id) {
    const Track& track = tracks_.at(id);
    return track.role == Role::waiting ? track.misfit : track.role != Role::landmark;
  }));
}

void TrackTable::become_landmark(TrackId id, int landmark) {
  Track& track = tracks_.at(id);
  track.role = Role::landmark;
  track.landmark = landmark;
  tracks_of_landmarks_.push_back(id);
  ++tracks_with_landmarks_;
  waiting_.forget(id);
}

void TrackTable::become_another(TrackId id, int landmark) {
  tracks_.at(id) = {.role = Role::landmark, .landmark = landmark};
  tracks_of_landmarks_.push_back(id);
}

void TrackTable::wait_again(TrackId id) {
  tracks_.at(id) = Track();
  --tracks_with_landmarks_;
}

void TrackTable::end_track_of(int landmark, Role role) {
  const auto id = track_of(landmark);
  if (!id) return;
  tracks_.at(*id).role = role;
  outliers_.push_back(*id);
  if (role == Role::outlier) --tracks_with_landmarks_;
}

void TrackTable::mismatch(TrackId id) {
  Track& track = tracks_.at(id);
  if (!track.ended) {
    track.mismatched = true;
    outliers_.push_back(id);
  }
  track.ended = true;
}

std::optional<TrackId> TrackTable::track_of(int landmark) const {
  const TrackId id = tracks_of_landmarks_[index(landmark)];
  const Track* const track = find(id);
  if (track == nullptr || track->landmark != landmark) return std::nullopt;
  return id;
}

void TrackTable::recall(const std::function<bool(int landmark)>& is_alive) {
  std::set<TrackId> living;
  for (int j = 0; j < std::ssize(tracks_of_landmarks_); ++j) {
    if (is_alive(j)) living.insert(tracks_of_landmarks_[index(j)]);
  }
  for (const TrackId id : remembered_.ids()) {
    Track& track = tracks_.try_emplace(id, Track{.ended = true}).first->second;
    if (living.contains(id)) continue;
    track = {.ended = track.ended};
    waiting_.forget(id);
    waiting_.add(remembered_.observations(id));
    live_.insert(id);
    std::erase(outliers_, id);
  }
}

}  // namespace evbench::gp_map
