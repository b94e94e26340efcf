#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "backends/gp_map/gp_map.hpp"

// A map may be wrong: what is explained better otherwise goes on so, a camera that landmarks of before see elsewhere
// goes on there, and an initial map that most tracks do not fit makes way for another one, unless they fitted it once.
namespace evbench::gp_map {
namespace {

constexpr double kReconsidering = 0.15;  ///< [s] at least between two looks for another explanation
constexpr int kSettling = 3;             ///< steps from what one has found

}  // namespace

/// What came into view of late, or all of a young map, in turn, may be explained otherwise: on one of two planes, in
/// turn.
void GpMap::reconsider_recent() {
  if (!is_tentative() && !map_->search) tentative_ = TrackBuffer();
  const double now = graph().states.back().t;
  if (!map_->search && !(now < map_->next_look)) {
    map_->next_look = now + kReconsidering;
    const auto supposed = map_->searches % MapEstimate::kPlanes == 0 ? StructureHypothesis::frontal_plane : StructureHypothesis::dual_plane;
    map_->search = begin_search(supposed, is_tentative() && map_->searches % (2 * MapEstimate::kPlanes) < MapEstimate::kPlanes);
    if (!map_->search && is_tentative()) map_->search = begin_search(supposed, true);
    if (!map_->search && map_->pending_checks > 0) --map_->pending_checks;  // there is nothing that could be explained otherwise
    ++map_->searches;
  }
  if (!map_->search || map_->search->go_on()) return;
  auto other = map_->search->found();
  map_->search.reset();
  const int oldest = map_->engine.first_state();
  if (other && oldest > 0 && other->first <= oldest + 1) other.reset();  // a lag has marginalised it since
  if (map_->pending_checks > 0) map_->pending_checks = other ? MapEstimate::kPlanes : map_->pending_checks - 1;
  if (other) go_on_with(*other);
}

std::optional<HypothesisSearch> GpMap::begin_search(StructureHypothesis supposed, bool young) const {
  const StateRange states{map_->engine.first_state(), static_cast<int>(graph().states.size()) - 1};
  return HypothesisSearch::begin(graph(), states, options_.health.min_landmarks, supposed, young);
}

void GpMap::go_on_with(const RecentHypothesis& other) {
  context_.log(fmt::format("{:.3f} s: {} is explained better otherwise, by {:.1f}", graph().states.back().t,
                           other.first > 0 ? "what came into view of late" : "all that was seen", other.advantage));
  other.place_in(map_->engine);
  const auto known = static_cast<int>(map_->known.size());
  if (other.first == 0) recall_rejected();
  bound_leverage();
  for (int step = 0; step < kSettling; ++step) map_->last_update = map_->engine.update();
  for (int j = known; j < std::ssize(map_->known); ++j) {
    if (is_outlier(j)) become_outlier(j);
  }
  map_->recent.forget();
}

/// Landmarks that have come back beside where they are expected: the camera is elsewhere, or else those that stay far
/// off are not what they were taken for, and go back to where they were; unless most of many are, as then it is the
/// motion that is wrong.
void GpMap::check_reappeared() {
  constexpr double kOfLate = 0.2;  // [s]
  constexpr double kPause = 0.04;  // [s] from one time that the camera may be found elsewhere to the next
  constexpr double kFar = 3.0;     // [px]
  constexpr std::ptrdiff_t kMany = 5;
  auto& reappeared = map_->reappeared;
  std::erase_if(reappeared, [&](const auto& entry) {
    const auto track = tracks_.find(entry.first);
    return track == tracks_.end() || track->second.role != Track::Role::landmark ||
           track->second.landmark != entry.second.landmark;
  });
  const double now = graph().states.back().t;
  if (!(now < map_->next_jump_search)) {
    map_->next_jump_search = now + kPause;
    std::vector<Reappearance> seen;
    for (const auto& [track, reappearance] : reappeared) seen.push_back(reappearance);
    if (correct_pose_jump(map_->engine, seen)) {
      context_.log(fmt::format("{:.3f} s: the camera is elsewhere, as landmarks tell that came back", now));
      map_->search.reset();  // it looks for another explanation of what was before
      map_->recent.forget();
    }
  }
  const auto is_far = [&](const auto& entry) { return reappearance_error(graph(), entry.second) > kFar; };
  const auto far = std::ranges::count_if(reappeared, is_far);
  const bool judged = !is_tentative() && (std::ssize(reappeared) < kMany || 2 * far <= std::ssize(reappeared));
  std::erase_if(reappeared, [&](const auto& entry) {
    if (now - entry.second.t < kOfLate) return false;
    if (judged && is_far(entry)) send_back(entry.first, entry.second);
    return true;
  });
}

/// A track that came back is not its landmark, at least until it ends.
void GpMap::send_back(TrackId id, const Reappearance& seen) {
  Track& track = tracks_.at(id);
  map_->engine.remove_observations(seen.landmark, seen.t);
  if (!track.ended) {
    track.astray = true;
    map_->outliers.push_back(id);
  }
  track.ended = true;
}

/// What did not fit an explanation that was wrong may be a landmark of the right one; where one of it lives, it is not
/// told anew what it knows.
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

/// Of the tracks that are alive, those that are not where the map lets expect them: the landmarks of a map that is
/// wrong are condemned or go out of view, and for most of what comes into it there is no place.
int GpMap::misfits() const {
  return static_cast<int>(std::ranges::count_if(live_, [&](TrackId id) {
    const Track& track = tracks_.at(id);
    return track.role == Track::Role::waiting ? track.misfit : track.role != Track::Role::landmark;
  }));
}

/// Once another explanation was looked for in vain on each plane, a map that most tracks fit is doubted no more.
void GpMap::trust_what_fits() {
  if (map_->pending_checks == 0 && misfits() <= landmarks_in_view()) map_->confirmed = true;
}

/// An initial map can be wrong altogether. One that most tracks have fitted is not: what they do later has other reasons.
/// Where most tracks follow nothing, none is better: that is found out soon.
bool GpMap::is_rejected() const {
  constexpr int kMost = 2;   // times as many as are landmarks
  constexpr int kTimes = 3;  // that one makes way
  const bool was_told = std::isfinite(published_), data_go_on = graph().states.back().t < until_;
  if (was_told || !is_pending() || map_->pending_checks > 0 || !data_go_on || times_rejected_ == kTimes) return false;
  const int without_place = misfits();
  return without_place >= options_.initialiser.min_tracks && without_place > kMost * landmarks_in_view();
}

/// Without a map, as before the first one; from the next one the trajectory reaches back to where this one began.
/// States that stood close together, as predictions from a wrong map are far off, would slow down its looks.
void GpMap::reinitialise() {
  constexpr double kApart = 0.02;  // [s]
  context_.log(fmt::format("{:.3f} s: the initial map has no place for most tracks: another one is looked for",
                           graph().states.back().t));
  for (const ControlState& state : graph().states) {
    if (state.t >= initial_map_.newest() + kApart) initial_map_.pass(state.t);
  }
  initial_map_.reinitialise();
  ++times_rejected_;
  reinitialised_ = true;
  map_.reset();
  monitor_ = TrackingMonitor(context_.patience);  // what it said was of that map
  for (auto& [id, track] : tracks_) track = {.ended = track.ended};
  waiting_ = std::exchange(tentative_, {});
  for (const TrackId id : waiting_.ids()) {
    tracks_.try_emplace(id, Track{.ended = true});
    live_.insert(id);
  }
}

}  // namespace evbench::gp_map
