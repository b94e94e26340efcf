#include <algorithm>
#include <utility>

#include "core/events/event_time.hpp"
#include "frontends/haste/haste.hpp"

// Re-acquires landmarks whose trackers have ended: where they are expected, displaced together, or by their template
// alone after tracking is lost.
namespace evbench::haste {

/// Stores the track's template where the track is of a landmark.
void Haste::remember(const Track& track, const Tracker& tracker) {
  const bool itself = track.probation == 0 && !track.displaced && guidance_.position(track.id);
  if (!options_.guidance.reacquire || !itself) return;
  lost_.remember(track.id, clock_, tracker.learnt_template(), tracker.state().angle, guidance_);
}

/// Searches for landmarks that come back into view, as long as there are trackers left.
void Haste::reacquire() {
  if (trackers_.size() >= static_cast<std::size_t>(2 * options_.tracks)) return;
  const auto found = lost_.find(guidance_, clock_, recent_, tracked(), options_.life.crowding + 1.0, camera_);
  for (const LostLandmarks::Found& landmark : found) {
    ++by_template_.found;
    begin(Tracker(options_.tracker, {0, landmark.pixel, 0.0}, landmark.look),
          {landmark.track, odometer_, landmark.pixel, options_.guidance.probation});
  }
}

/// Where the camera has turned unnoticed. Trackers that are there already follow these landmarks. The back-end confirms
/// or rejects the re-association.
void Haste::reacquire_displaced() {
  if (trackers_.size() >= static_cast<std::size_t>(2 * options_.tracks)) return;
  for (const LostLandmarks::Found& landmark : lost_.find_displaced(guidance_, clock_, recent_, tracked(), camera_)) {
    std::vector<std::int64_t> there;
    for (const auto& [tracker, track] : tracks_) {
      if ((track.pixel - landmark.pixel).norm() < options_.life.crowding) there.push_back(tracker);
    }
    for (const std::int64_t tracker : there) end(tracker, End::crowding);
    ++begun_displaced_;
    begin(Tracker(options_.tracker, {0, landmark.pixel, 0.0}, landmark.look),
          {.id = landmark.track, .odometer = odometer_, .pixel = landmark.pixel, .displaced = true});
  }
}

/// After tracking is lost, new trackers may be on landmarks of the earlier map, wherever these are now. Compares a few
/// trackers at a time.
void Haste::recognise() {
  constexpr std::size_t kAtATime = 4;
  constexpr int kTimes = 3;
  if (!lost_.has_of_another(guidance_.world())) return;
  std::vector<std::int64_t> candidates;
  for (const auto& [tracker, track] : tracks_) {
    const bool is_new = track.looked_at < kTimes && track.probation == 0 && !guidance_.position(track.id);
    if (is_new && trackers_.tracker(tracker).running()) candidates.push_back(tracker);
  }
  std::ranges::stable_sort(candidates, {}, [&](std::int64_t tracker) { return tracks_.at(tracker).looked_at; });
  if (candidates.size() > kAtATime) candidates.resize(kAtATime);
  for (const std::int64_t tracker : candidates) {
    Track& track = tracks_.at(tracker);
    ++track.looked_at;
    auto found = lost_.recognise(track.pixel, guidance_.world(), recent_, clock_, tracked());
    if (!found) continue;
    end(tracker, End::recognised);
    lost_.forget(found->track);
    begin(Tracker(options_.tracker, {0, found->pixel, 0.0}, found->look),
          {.id = found->track, .odometer = odometer_, .pixel = found->pixel, .looked_at = kTimes});
  }
}

LostLandmarks::Tracked Haste::tracked() const {
  LostLandmarks::Tracked result;
  for (const auto& [tracker, track] : tracks_) {
    result.tracks.push_back(track.id);
    result.places.push_back(track.pixel);
  }
  return result;
}

}  // namespace evbench::haste
