#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "backends/gp_map/gp_map.hpp"

// Checks of the map. A better alternative estimate replaces the present one, a pose jump is corrected, and an initial
// map that most tracks do not fit is rejected unless they fitted it before.
namespace evbench::gp_map {
namespace {

constexpr int kSettling = 3;  ///< updates after an alternative estimate is adopted

}  // namespace

/// Searches a better alternative estimate of the recent part or, in turn, of a whole tentative map, with one of two
/// planes, in turn.
void GpMap::search_alternatives() {
  if (!options_.parts.search) {
    map_->pending_checks = 0;
    return;
  }
  if (!is_tentative() && !map_->search) tentative_ = TrackBuffer();
  const double now = graph().states.back().t;
  if (!map_->search && !(now < map_->next_search)) {
    map_->next_search = now + options_.map.search_interval;
    const auto hypothesis = map_->searches % MapEstimate::kPlanes == 0 ? StructureHypothesis::frontal_plane
                                                                       : StructureHypothesis::dual_plane;
    map_->search =
        begin_search(hypothesis, is_tentative() && map_->searches % (2 * MapEstimate::kPlanes) < MapEstimate::kPlanes);
    if (!map_->search && is_tentative()) map_->search = begin_search(hypothesis, true);
    if (!map_->search && map_->pending_checks > 0) --map_->pending_checks;  // no alternative is possible
    ++map_->searches;
  }
  if (!map_->search || map_->search->run_share()) return;
  auto other = map_->search->found();
  map_->search.reset();
  const int oldest = map_->engine.first_state();
  if (other && oldest > 0 && other->first <= oldest + 1) other.reset();  // a lag has marginalised it since
  if (map_->pending_checks > 0) map_->pending_checks = other ? MapEstimate::kPlanes : map_->pending_checks - 1;
  if (other) adopt(*other);
}

std::optional<HypothesisSearch> GpMap::begin_search(StructureHypothesis hypothesis, bool tentative) const {
  const StateRange states{map_->engine.first_state(), static_cast<int>(graph().states.size()) - 1};
  return HypothesisSearch::begin(graph(), states, options_.health.min_landmarks, hypothesis, tentative);
}

void GpMap::adopt(const RecentHypothesis& other) {
  context_.log(fmt::format("{:.3f} s: a better alternative estimate of {}, by {:.1f}", graph().states.back().t,
                           other.first > 0 ? "the recent part" : "everything", other.advantage));
  other.place_in(map_->engine);
  const auto known = static_cast<int>(map_->known.size());
  if (other.first == 0) recall_rejected();
  bound_leverage();
  for (int step = 0; step < kSettling; ++step) map_->last_update = map_->engine.update();
  for (int j = known; options_.parts.outliers && j < std::ssize(map_->known); ++j) {
    if (is_outlier(j)) become_outlier(j);
  }
  map_->recent.reset();
}

/// Checks the re-acquired landmarks that are seen away from their expected places. Either the pose of the camera has
/// jumped, or those that stay far off are wrong re-associations and are rejected. None is rejected if they are most of
/// many, because then the motion is wrong.
void GpMap::check_reappeared() {
  constexpr double kRecent = 0.2;  // [s]
  constexpr double kPause = 0.04;  // [s] between tests for a pose jump
  constexpr double kFar = 3.0;     // [px]
  constexpr std::ptrdiff_t kMany = 5;
  auto& reappeared = map_->reappeared;
  std::erase_if(reappeared, [&](const auto& entry) {
    const auto track = tracks_.find(entry.first);
    return track == tracks_.end() || track->second.role != Track::Role::landmark ||
           track->second.landmark != entry.second.landmark;
  });
  const double now = graph().states.back().t;
  if (options_.parts.pose_jump && !(now < map_->next_jump_search)) {
    map_->next_jump_search = now + kPause;
    std::vector<Reappearance> seen;
    for (const auto& [track, reappearance] : reappeared) seen.push_back(reappearance);
    if (correct_pose_jump(map_->engine, seen)) {
      context_.log(fmt::format("{:.3f} s: a pose jump is corrected, according to re-acquired landmarks", now));
      map_->search.reset();  // its alternative is one to the estimate before
      map_->recent.reset();
    }
  }
  const auto is_far = [&](const auto& entry) { return reappearance_error(graph(), entry.second) > kFar; };
  const auto far = std::ranges::count_if(reappeared, is_far);
  const bool checked = options_.parts.reassociations && !is_tentative() &&
                       (std::ssize(reappeared) < kMany || 2 * far <= std::ssize(reappeared));
  std::erase_if(reappeared, [&](const auto& entry) {
    if (now - entry.second.t < kRecent) return false;
    if (checked && is_far(entry)) reject_reassociation(entry.first, entry.second);
    return true;
  });
}

/// The track does not show its landmark, at least until it ends.
void GpMap::reject_reassociation(TrackId id, const Reappearance& seen) {
  Track& track = tracks_.at(id);
  map_->engine.remove_observations(seen.landmark, seen.t);
  if (!track.ended) {
    track.mismatched = true;
    map_->outliers.push_back(id);
  }
  track.ended = true;
}

/// Tracks that did not fit a wrong estimate may be landmarks of the right one, and are tried again. Tracks that are
/// landmarks stay so; their observations are not added again.
void GpMap::recall_rejected() {
  std::set<TrackId> living;
  for (std::size_t j = 0; j < map_->known.size(); ++j) {
    if (graph().landmarks[j].alive) living.insert(map_->known[j].track);
  }
  for (const TrackId id : tentative_.ids()) {
    Track& track = tracks_.try_emplace(id, Track{.ended = true}).first->second;
    track.covariance.reset();
    if (living.contains(id)) continue;
    track = {.ended = track.ended};
    waiting_.forget(id);
    waiting_.add(tentative_.observations(id));
    live_.insert(id);
    std::erase(map_->outliers, id);
  }
  add_landmarks();
}

/// Counts live tracks that do not fit the map: the landmarks of a wrong map are rejected or leave the view, and most
/// new tracks cannot be located in it.
int GpMap::mismatched_tracks() const {
  return static_cast<int>(std::ranges::count_if(live_, [&](TrackId id) {
    const Track& track = tracks_.at(id);
    return track.role == Track::Role::waiting ? track.misfit : track.role != Track::Role::landmark;
  }));
}

/// Confirms a map that most tracks fit once the search for an alternative has failed on each plane.
void GpMap::confirm_map() {
  if (map_->pending_checks == 0 && mismatched_tracks() <= landmarks_in_view()) map_->confirmed = true;
}

/// An initial map can be wrong altogether. A map that most tracks have fitted is not: their later errors have other
/// reasons. If most tracks follow nothing, no other map is better; few repetitions show this.
bool GpMap::is_rejected() const {
  constexpr int kMost = 2;   // times the number of landmarks
  constexpr int kTimes = 3;  // rejections at most
  const bool has_published = std::isfinite(published_), data_continue = graph().states.back().t < until_;
  if (has_published || !is_pending() || map_->pending_checks > 0 || !data_continue || times_rejected_ == kTimes)
    return false;
  const int without_place = mismatched_tracks();
  return without_place >= options_.initialiser.min_tracks && without_place > kMost * landmarks_in_view();
}

/// Drops the map, as before the first one. The trajectory of the next map reaches back to the beginning of this one.
/// Close states are left out: there are many of them because predictions from a wrong map are far off, and they would
/// slow down the attempts.
void GpMap::reinitialise() {
  constexpr double kApart = 0.02;  // [s]
  context_.log(
      fmt::format("{:.3f} s: the initial map is rejected: most tracks do not fit it", graph().states.back().t));
  for (const ControlState& state : graph().states) {
    if (state.t >= initial_map_.newest() + kApart) initial_map_.add_state_time(state.t);
  }
  initial_map_.reinitialise();
  ++times_rejected_;
  reinitialised_ = true;
  map_.reset();
  monitor_ = TrackingMonitor(context_.patience);  // its status is that of the rejected map
  for (auto& [id, track] : tracks_) track = {.ended = track.ended};
  waiting_ = std::exchange(tentative_, {});
  for (const TrackId id : waiting_.ids()) {
    tracks_.try_emplace(id, Track{.ended = true});
    live_.insert(id);
  }
}

}  // namespace evbench::gp_map
