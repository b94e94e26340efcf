#include "backends/gp_map/gp_map.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "backends/gp_map/problem_graph.hpp"
#include "core/plugin/registration.hpp"
#include "core/support/seconds_since.hpp"

namespace evbench::gp_map {
namespace {

const Registration<BackEnd, GpMap> registration("gp_map",
                                                "asynchronous MAP estimation under a GP prior (Liu et al. 2022)", 25);

// Learning with hindsight while running [s]:
constexpr double kEvery = 0.3, kHindsight = 1.0;
constexpr double kOneSided = 0.1;  ///< what was seen so shortly ago is known from one side
constexpr double kYoung = 5.0;     ///< [s] of a map in which all may be explained otherwise, and no track is judged
constexpr double kMemory = 10.0;   ///< [s] for which tracks are remembered that ended before there is a map

// Searches for another explanation:
constexpr double kFirstLook = 0.7;       ///< [s] of data that the first one takes
constexpr double kReconsidering = 0.15;  ///< [s] at least between two
constexpr int kSettling = 3;             ///< steps from what one has found
constexpr int kPlanes = 2;               ///< on which it is looked for, in turn; until both were, the map is in doubt

}  // namespace

GpMap::GpMap(const Options& options, const BackEndContext& context)
    : options_(options),
      context_(context),
      placement_(options.placement),
      first_map_(options, context.camera),
      returns_(options.map.returns),
      violent_motion_(options.health.min_landmarks, options.learn.window),
      prior_(options.learn.window, options.learn.memory),
      information_told_(RobustLoss(options.loss, options.loss_width).information_told()),
      monitor_(context.patience) {}

void GpMap::advance(const TrackBatch& batch) {
  for (const TrackObservation& z : batch.observations) placement_.observe(z);
  pending_.insert(pending_.end(), batch.observations.begin(), batch.observations.end());
  ending_.insert(ending_.end(), batch.ended.begin(), batch.ended.end());
  until_ = batch.until;
  ended_landmarks_.clear();
  while (const std::optional<double> next = placement_.next(until_)) {
    if (options_.per_observation) follow_observations(*next, *next);
    step(*next);
  }
  if (options_.per_observation) follow_observations(until_, placement_.upcoming());
}

void GpMap::step(double t) {
  if (monitor_.lost()) return;
  const auto start = std::chrono::steady_clock::now();
  take_observations(t);
  if (engine_ || initialise(t)) {
    remove_outliers();
    extrapolate_state(t);
    add_observations();
    trust_parallax();
    add_landmarks();
    bound_leverage();
    optimise();
    learn();
    reconsider_recent();
    nearly_in_view_.reset();
    if (doubts_ == 0 && misfits() <= landmarks_in_view()) trusted_ = true;
    if (is_refuted()) {
      begin_anew();
    } else {
      check_support();
      tell_recent(t);
      predict_tracks();
    }
  }
  forget_ended_tracks(t);
  add_record(t, std::exchange(seconds_since_step_, 0.0) + seconds_since(start), 1, {});
}

/// Observations up to the new control state, no later ones: the estimate at a time depends on what was seen until then.
void GpMap::take_observations(double t) {
  const auto later = std::ranges::upper_bound(pending_, t, {}, &TrackObservation::t);
  const auto ending_later = std::ranges::upper_bound(ending_, t, {}, &TrackEnd::t);
  const auto end = [&](const TrackEnd& ended) {
    const auto track = tracks_.find(ended.track);
    if (track != tracks_.end()) track->second.ended = true;
  };
  in_time_order(
      std::span(pending_.begin(), later), std::span(ending_.begin(), ending_later),
      [&](const TrackObservation& z) { take(z); }, end);
  pending_.erase(pending_.begin(), later);
  ending_.erase(ending_.begin(), ending_later);
}

void GpMap::take(const TrackObservation& z) {
  Track& track = tracks_[z.track];
  live_.insert(z.track);
  if (track.role == Track::Role::landmark && !goes_on(track)) split(z.track);
  track.ended = false;
  if (track.role == Track::Role::waiting) waiting_.add({&z, 1});
  if (!young_.empty()) young_.add({&z, 1});
  if (track.role == Track::Role::landmark) new_.emplace_back(track.landmark, to_observation(z, options_.sigma_scale));
}

/// Whether the landmark of a track that is seen now is the one that it was.
bool GpMap::goes_on(const Track& track) {
  if (engine_->forgotten(track.landmark)) return false;
  const auto& seen = graph().landmarks[index(track.landmark)].intervals;
  const int newest = static_cast<int>(graph().states.size()) - 1;
  return !track.ended || seen.empty() || seen.back() >= newest || returns_.spend(seen.back(), newest + 1);
}

/// A track that came back becomes another landmark, which is expected where the one is that it was; that one stays as
/// what it has been seen to be. What is known of it counts as independent of the motion since.
void GpMap::split(TrackId id) {
  Track& track = tracks_.at(id);
  const std::optional<Matrix3> known = covariance_of_ended(track);
  if (!known) {
    track = Track();
    --landmarks_;
    return;
  }
  const Vector3 position = graph().landmarks[index(track.landmark)].position;
  const double sigma = std::sqrt(known->selfadjointView<Eigen::Lower>().eigenvalues().maxCoeff());
  track = {.role = Track::Role::landmark, .landmark = engine_->add_landmark(position, {position, sigma})};
  known_.push_back({.track = id});
}

bool GpMap::initialise(double t) {
  auto map = first_map_.attempt(waiting_, t);
  if (!map) return false;
  young_ = waiting_;
  violent_motion_.begin(map->graph.qc);
  engine_.emplace(std::move(map->graph), EngineOptions{.lag = options_.lag});
  young_until_ = graph().states.back().t + kYoung;
  next_hindsight_ = graph().states.front().t + kHindsight;
  next_search_ = graph().states.front().t + kFirstLook;
  doubts_ = kPlanes;
  trusted_ = false;
  recent_.emplace(
      options_.learn.prior == LearnPrior::never
          ? std::nullopt
          : std::optional<RecentPrior>(std::in_place, options_.learn.window, options_.learn.memory, graph().qc));
  for (const TrackId track : map->tracks) become_landmark(track, static_cast<int>(known_.size()));
  context_.log(
      fmt::format("{:.3f} s: first map: {} landmarks, {} observations, median parallax {:.1f} deg, from {:.3f} s",
                  graph().states.back().t, graph().landmarks.size(), graph().observation_count(), map->parallax_deg,
                  graph().states.front().t));
  return true;
}

void GpMap::extrapolate_state(double t) {
  follower_.close(*engine_, t);
  if (graph().states.back().t < t) add_extrapolated_state(*engine_, t);
}

/// Those of tracks that are landmarks; the others wait in the track buffer until theirs are located.
void GpMap::add_observations() {
  for (const auto& [landmark, z] : new_) engine_->add_observation(landmark, z);
  new_.clear();
}

void GpMap::optimise() {
  last_update_ = engine_->update();
  last_update_ = violent_motion_.follow(*engine_, noise_, last_update_);
}

/// Prior and noise from what has been seen until now.
void GpMap::learn() {
  if (options_.learn.noise) {
    noise_.follow(graph(), options_.learn.memory);
    engine_->set_loss(noise_.loss(options_.loss, options_.loss_width));
  }
  if (options_.learn.prior == LearnPrior::always) {
    prior_.follow(*engine_);
  } else {
    violent_motion_.recover(*engine_);
  }
  const double now = graph().states.back().t;
  if (now < next_hindsight_) return;
  next_hindsight_ = now + kEvery;
  learn_with_hindsight({now - kHindsight, now - kOneSided});
  last_update_ = engine_->update();
}

/// What came into view of late, or all of a young map, in turn, may be explained otherwise: on one of two planes, in
/// turn.
void GpMap::reconsider_recent() {
  if (!is_young() && !search_) young_ = TrackBuffer();
  const double now = graph().states.back().t;
  if (!search_ && !(now < next_search_)) {
    next_search_ = now + kReconsidering;
    const auto supposed = looks_ % kPlanes == 0 ? Supposed::frontal_plane : Supposed::dual_plane;
    search_ = begin_search(supposed, is_young() && looks_ % (2 * kPlanes) < kPlanes);
    if (!search_ && is_young()) search_ = begin_search(supposed, true);
    if (!search_ && doubts_ > 0) --doubts_;  // there is nothing that could be explained otherwise
    ++looks_;
  }
  if (!search_ || search_->go_on()) return;
  auto other = search_->found();
  search_.reset();
  const int oldest = engine_->first_state();
  if (other && oldest > 0 && other->first <= oldest + 1) other.reset();  // a lag has marginalised it since
  if (doubts_ > 0) doubts_ = other ? kPlanes : doubts_ - 1;
  if (other) go_on_with(*other);
}

std::optional<ExplanationSearch> GpMap::begin_search(Supposed supposed, bool young) const {
  const StateRange states{engine_->first_state(), static_cast<int>(graph().states.size()) - 1};
  return ExplanationSearch::begin(graph(), states, options_.health.min_landmarks, supposed, young);
}

void GpMap::go_on_with(const RecentExplanation& other) {
  context_.log(fmt::format("{:.3f} s: {} is explained better otherwise, by {:.1f}", graph().states.back().t,
                           other.first > 0 ? "what came into view of late" : "all that was seen", other.advantage));
  other.place_in(*engine_);
  const auto known = static_cast<int>(known_.size());
  if (other.first == 0) recall_condemned();
  bound_leverage();
  for (int step = 0; step < kSettling; ++step) last_update_ = engine_->update();
  for (int j = known; j < std::ssize(known_); ++j) {
    if (is_outlier(j)) become_outlier(j);
  }
  recent_->forget();
}

/// What did not fit an explanation that was wrong may be a landmark of the right one; where one of it lives, it is not
/// told anew what it knows.
void GpMap::recall_condemned() {
  std::set<TrackId> living;
  for (std::size_t j = 0; j < known_.size(); ++j) {
    if (graph().landmarks[j].alive) living.insert(known_[j].track);
  }
  for (const TrackId id : young_.ids()) {
    Track& track = tracks_.try_emplace(id, Track{.ended = true}).first->second;
    track.covariance.reset();
    if (living.contains(id)) continue;
    track = {.ended = track.ended};
    waiting_.forget(id);
    waiting_.add(young_.observations(id));
    live_.insert(id);
    std::erase(new_outliers_, id);
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

/// A first map can be wrong altogether. One that most tracks have fitted is not: what they do later has other reasons.
/// Where most tracks follow nothing, none is better: that is found out soon.
bool GpMap::is_refuted() const {
  constexpr int kMost = 2;   // times as many as are landmarks
  constexpr int kTimes = 3;  // that one makes way
  const bool data_go_on = graph().states.back().t < until_;
  if (!is_in_doubt() || doubts_ > 0 || !data_go_on || times_refuted_ == kTimes) return false;
  const int without_place = misfits();
  return without_place >= options_.initialiser.min_tracks && without_place > kMost * landmarks_in_view();
}

/// Without a map, as before the first one; from the next one the trajectory reaches back to where this one began.
/// States that stood close together, as predictions from a wrong map are far off, would slow down its looks.
void GpMap::begin_anew() {
  constexpr double kApart = 0.02;  // [s]
  context_.log(fmt::format("{:.3f} s: the first map has no place for most tracks: another one is looked for",
                           graph().states.back().t));
  for (const ControlState& state : graph().states) {
    if (state.t >= first_map_.newest() + kApart) first_map_.pass(state.t);
  }
  first_map_.begin_anew();
  ++times_refuted_;
  engine_.reset();
  search_.reset();
  looks_ = 0;
  follower_ = {};
  recent_.reset();
  noise_ = {};
  prior_ = PriorLearner(options_.learn.window, options_.learn.memory);
  hindsight_qc_.reset();
  monitor_ = TrackingMonitor(context_.patience);  // what it said was of that map
  known_.clear();
  guessed_.clear();
  new_.clear();
  ended_landmarks_.clear();
  new_outliers_.clear();
  newest_covariance_ = {};
  returns_ = ReturnBudget(options_.map.returns);
  landmarks_ = 0;
  for (auto& [id, track] : tracks_) track = {.ended = track.ended};
  waiting_ = std::exchange(young_, {});
  for (const TrackId id : waiting_.ids()) {
    tracks_.try_emplace(id, Track{.ended = true});
    live_.insert(id);
  }
}

/// What was seen a while ago is known from both sides: tracks show whether they stayed on their points, and the motion
/// how smooth it was. The newest motion, known from one side alone, keeps a prior that allows for what may come.
void GpMap::learn_with_hindsight(const TimeSpan& span, std::span<const double> surplus) {
  if (!is_young()) judge_tracks(noise_, span);  // a young map itself is not right yet
  const bool yields = options_.learn.prior != LearnPrior::always && violent_motion_.is_yielding(graph());
  if (options_.learn.noise && !yields) weigh_tracks(noise_, span);
  if (options_.learn.prior == LearnPrior::never) return;
  learn_prior(*engine_, span, surplus);
  const int k = graph().first_state_after(span.until) - 1;
  if (k > engine_->first_state()) hindsight_qc_ = graph().qcs[index(k)];
}

/// What is seen next is compared with the newest state's constant velocity.
void GpMap::predict_tracks() {
  constexpr double kLargestSpread = 2.0;
  const double noise = std::min(kLargestSpread * noise_.scale(), noise_.scale_of_means()) * options_.sigma_scale;
  placement_.predict([this, noise, newest = graph().states.back()](const TrackObservation& z) {
    std::optional<double> deviation;
    const auto track = tracks_.find(z.track);
    if (track == tracks_.end() || track->second.role != Track::Role::landmark) return deviation;
    const SE3 T = extrapolate(newest, z.t - newest.t).T;
    const Vector3 point = T.inverse() * graph().landmarks[index(track->second.landmark)].position;
    if (point.z() > 0.0) {
      deviation = (graph().camera.project(point) - z.pixel).norm() / (noise * z.sigma);
    }
    return deviation;
  });
}

void GpMap::check_support() {
  using Support = TrackingMonitor::Support;
  const std::size_t n = graph().states.size();
  const double from = graph().states[n - 2].t, to = graph().states[n - 1].t;
  const int seen = landmarks_in_view(), enough = options_.health.min_landmarks, few = options_.health.lost_landmarks;
  if (last_update_.unsolvable) {
    monitor_.lose(to, last_update_.reason);
  } else if (to > until_) {
    return;  // the data ends, and with it its tracks
  } else if (seen < few) {
    monitor_.observe(from, to, Support::none, fmt::format("fewer than {} landmarks in view", few));
  } else {
    monitor_.observe(from, to, seen < enough ? Support::weak : Support::full,
                     fmt::format("fewer than {} landmarks in view: the motion prior carries", enough));
  }
  if (!monitor_.lost()) return;
  context_.log(fmt::format("{:.3f} s: lost: {}", monitor_.status().time, monitor_.status().reason));
  // What the data never saw is not kept.
  const auto oldest = index(engine_->first_state());  // with a lag, what is older is settled
  while (graph().states.size() > oldest + 2 && graph().states.back().t > monitor_.status().time) {
    engine_->remove_newest_state();
  }
}

/// They had their last chance to become landmarks in the step that saw their end; before the first map, in the one that
/// makes it, unless that is long after.
void GpMap::forget_ended_tracks(double t) {
  if (!engine_) waiting_.forget_ended_before(t - kMemory);
  std::erase_if(live_, [&](TrackId id) {
    const auto track = tracks_.find(id);
    if (!track->second.ended || (!engine_ && !waiting_.observations(id).empty())) return false;
    if (track->second.role == Track::Role::landmark) ended_landmarks_.push_back(id);
    if (track->second.role == Track::Role::waiting) {
      waiting_.forget(id);
      tracks_.erase(track);
    }
    return true;
  });
}

/// Between two steps, observations up to t are followed one by one, towards a state that stands ahead of them.
void GpMap::follow_observations(double t, double ahead) {
  if (!engine_ || monitor_.lost()) return;
  const auto start = std::chrono::steady_clock::now();
  take_observations(t);
  if (!new_.empty()) follower_.open(*engine_, ahead);
  for (const auto& [landmark, z] : new_) {
    follower_.follow(*engine_, landmark, z);
    tell_online(z.t);
  }
  new_.clear();
  seconds_since_step_ += seconds_since(start);
}

/// Those whose tracks have been alive since the last step: one that has not been observed of late is where it was.
int GpMap::landmarks_in_view() const {
  return static_cast<int>(
      std::ranges::count(live_, Track::Role::landmark, [&](TrackId track) { return tracks_.at(track).role; }));
}

void GpMap::add_record(double t, double seconds, int iterations, std::optional<double> cost) {
  UpdateRecord record{t, seconds, 0, 0, 0, iterations, cost};
  if (engine_) {
    record.states = static_cast<int>(graph().states.size());
    record.landmarks = landmarks_;
    record.observations = graph().observation_count();
    const Vector6& qc = hindsight_qc_ && options_.learn.prior == LearnPrior::hindsight ? *hindsight_qc_ : graph().qc;
    record.learnt = {noise_.scale(), noise_.share()};
    for (int column = 0; column < 2; ++column) record.learnt.insert(record.learnt.end(), qc.begin(), qc.end());
  }
  updates_.push_back(record);
}

}  // namespace evbench::gp_map
