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
                                                "asynchronous MAP estimation under a GP prior (Liu et al. 2022)", 28);

constexpr double kEvery = 0.3;     ///< [s] between smoothed re-estimations of prior and noise while running
constexpr double kOneSided = 0.1;  ///< [s] newer motion is observed from one side only
constexpr double kMemory = 10.0;   ///< [s] before there is a map, tracks are dropped this long after their end

}  // namespace

GpMap::GpMap(const Options& options, const BackEndContext& context)
    : options_(options),
      context_(context),
      placement_(options.placement),
      initial_map_(options, context.camera),
      information_share_(RobustLoss(options.loss, options.loss_width).information_share()),
      monitor_(context.patience) {}

void GpMap::advance(const TrackBatch& batch) {
  for (const TrackObservation& z : batch.observations) placement_.observe(z);
  pending_.insert(pending_.end(), batch.observations.begin(), batch.observations.end());
  ending_.insert(ending_.end(), batch.ended.begin(), batch.ended.end());
  until_ = batch.until;
  if (map_) map_->ended_landmarks.clear();
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
  if (map_ || initialise(t)) {
    if (options_.parts.outliers) remove_outliers();
    extrapolate_state(t);
    add_observations();
    drop_guessed_depths();
    add_landmarks();
    bound_leverage();
    optimise();
    check_reappeared();
    learn();
    search_alternatives();
    map_->end_step(options_.health.min_landmarks);
    confirm_map();
    if (options_.parts.rejection && is_rejected()) {
      reinitialise();
    } else {
      check_support();
      publish_recent(t);
      predict_tracks();
    }
  }
  drop_ended_tracks(t);
  add_record(t, std::exchange(seconds_since_step_, 0.0) + seconds_since(start), 1, {});
}

/// Takes the observations up to the new control state and no later ones: the estimate at a time depends on data until
/// then.
void GpMap::take_observations(double t) {
  const auto later = std::ranges::upper_bound(pending_, t, {}, &TrackObservation::t);
  const auto ending_later = std::ranges::upper_bound(ending_, t, {}, &TrackEnd::t);
  const auto end = [&](const TrackEnd& ended) {
    const auto track = tracks_.find(ended.track);
    if (track == tracks_.end()) return;
    track->second.ended = true;
    track->second.mismatched = false;
  };
  in_time_order(
      std::span(pending_.begin(), later), std::span(ending_.begin(), ending_later),
      [&](const TrackObservation& z) { take(z); }, end);
  pending_.erase(pending_.begin(), later);
  ending_.erase(ending_.begin(), ending_later);
}

void GpMap::take(const TrackObservation& z) {
  Track& track = tracks_[z.track];
  if (track.mismatched) return;
  live_.insert(z.track);
  if (track.role == Track::Role::landmark) observe_landmark(track, z);
  track.ended = false;
  if (track.role == Track::Role::waiting) waiting_.add({&z, 1});
  if (!tentative_.empty()) tentative_.add({&z, 1});
  if (track.role == Track::Role::landmark)
    map_->new_observations.emplace_back(track.landmark, to_observation(z, options_.sigma_scale));
}

/// An observation of a landmark's track, perhaps of a re-acquired one.
void GpMap::observe_landmark(Track& track, const TrackObservation& z) {
  constexpr double kGone = 0.05;  // [s] shortest gap before a re-acquisition
  const std::vector<int>& intervals = graph().landmarks[index(track.landmark)].intervals;
  const int last = intervals.empty() ? 0 : intervals.back();
  const bool reappears = track.ended && last > 0 && z.t - graph().states[index(last)].t > kGone;
  if (!continue_landmark(track)) {
    split_track(z.track);
  } else if (reappears && !map_->reappeared.contains(z.track)) {
    map_->reappeared[z.track] = {track.landmark, z.t, z.pixel, last};
  }
}

/// Lets the track continue its landmark, a re-acquired one if the budget of returns allows it, of which it takes its
/// share. False: it can't.
bool GpMap::continue_landmark(const Track& track) {
  if (map_->engine.is_marginalised(track.landmark)) return false;
  const auto& seen = graph().landmarks[index(track.landmark)].intervals;
  const int newest = static_cast<int>(graph().states.size()) - 1;
  return !track.ended || seen.empty() || seen.back() >= newest || map_->returns.spend(seen.back(), newest + 1);
}

/// Makes a re-acquired track another landmark, with a prior where its old landmark is expected; the old one stays as it
/// is. The covariance of the old one counts as independent of the motion since.
void GpMap::split_track(TrackId id) {
  Track& track = tracks_.at(id);
  const std::optional<Matrix3> known = covariance_of_ended(track);
  if (!known) {
    track = Track();
    --map_->tracks;
    return;
  }
  const Vector3 position = graph().landmarks[index(track.landmark)].position;
  const double sigma = std::sqrt(known->selfadjointView<Eigen::Lower>().eigenvalues().maxCoeff());
  track = {.role = Track::Role::landmark, .landmark = map_->engine.add_landmark(position, {position, sigma})};
  map_->known.push_back({.track = id});
}

bool GpMap::initialise(double t) {
  auto map = initial_map_.attempt(waiting_, t);
  if (!map) return false;
  tentative_ = waiting_;
  map_.emplace(std::move(map->graph), options_);
  for (const TrackId track : map->tracks) become_landmark(track, static_cast<int>(map_->known.size()));
  context_.log(
      fmt::format("{:.3f} s: initial map: {} landmarks, {} observations, median parallax {:.1f} deg, from {:.3f} s",
                  graph().states.back().t, graph().landmarks.size(), graph().observation_count(), map->parallax_deg,
                  graph().states.front().t));
  return true;
}

void GpMap::extrapolate_state(double t) {
  map_->follower.close(map_->engine, t);
  if (graph().states.back().t < t) add_extrapolated_state(map_->engine, t);
}

/// Adds the observations of tracks that are landmarks. The others wait in the track buffer until their landmarks are
/// located.
void GpMap::add_observations() {
  for (const auto& [landmark, z] : map_->new_observations) map_->engine.add_observation(landmark, z);
  map_->new_observations.clear();
}

void GpMap::optimise() {
  map_->last_update = map_->engine.update();
  const AggressiveMotion& motion = map_->aggressive_motion;
  if (options_.parts.convergence) motion.converge(map_->engine, map_->noise, map_->last_update);
  if (options_.parts.relaxation) motion.relax_prior(map_->engine, map_->noise, map_->last_update);
}

/// Estimates prior and noise from the data until now.
void GpMap::learn() {
  if (options_.learn.noise) {
    map_->noise.follow(graph(), options_.learn.memory);
    map_->engine.set_loss(map_->noise.loss(options_.loss, options_.loss_width));
  }
  if (options_.learn.prior == LearnPrior::always) {
    map_->prior.follow(map_->engine);
  } else {
    map_->aggressive_motion.recover(map_->engine);
  }
  const double now = graph().states.back().t;
  if (now < map_->next_smoothed_learning) return;
  map_->next_smoothed_learning = now + kEvery;
  learn_from_smoothed({now - MapEstimate::kSmoothedReach, now - kOneSided});
  map_->last_update = map_->engine.update();
}

/// Smoothed re-estimation: older motion is observed from both sides, so that tracks show whether they drifted, and the
/// motion shows how smooth it was. The newest motion is observed from one side only; it keeps a prior that allows for
/// aggressive motion.
void GpMap::learn_from_smoothed(const TimeSpan& span, std::span<const double> surplus) {
  if (options_.parts.outliers && !is_tentative())
    reject_outliers(map_->noise, span);  // a tentative map may be wrong itself
  const bool relaxed = options_.learn.prior != LearnPrior::always && map_->aggressive_motion.is_prior_relaxed(graph());
  if (options_.learn.noise && options_.parts.track_noise && !relaxed) estimate_track_noise(map_->noise, span);
  if (options_.learn.prior == LearnPrior::never) return;
  learn_prior(map_->engine, span, surplus);
  const int k = graph().first_state_after(span.until) - 1;
  if (k > map_->engine.first_state()) map_->smoothed_qc = graph().qcs[index(k)];
}

/// Deviations of the next observations from the newest state's constant velocity determine the next control state.
void GpMap::predict_tracks() {
  constexpr double kLargestSpread = 2.0;
  const double noise =
      std::min(kLargestSpread * map_->noise.scale(), map_->noise.scale_of_means()) * options_.sigma_scale;
  placement_.predict([this, noise, newest = graph().states.back()](const TrackObservation& z) {
    std::optional<double> deviation;
    const auto track = tracks_.find(z.track);
    if (track == tracks_.end() || track->second.role != Track::Role::landmark || track->second.mismatched)
      return deviation;
    const SE3 T = extrapolate(newest, z.t - newest.t).T;
    const Vector3 point = T.inverse() * graph().landmarks[index(track->second.landmark)].position;
    if (point.z() > 0.0) {
      deviation = (z.noise.whitening() * Vector2(graph().camera.project(point) - z.pixel)).norm() / noise;
    }
    return deviation;
  });
}

void GpMap::check_support() {
  using Support = TrackingMonitor::Support;
  const std::size_t n = graph().states.size();
  const double from = graph().states[n - 2].t, to = graph().states[n - 1].t;
  const int seen = landmarks_in_view(), enough = options_.health.min_landmarks, few = options_.health.lost_landmarks;
  if (map_->last_update.unsolvable) {
    monitor_.lose(to, map_->last_update.reason);
  } else if (to > until_) {
    return;  // the data end, and their tracks with them
  } else if (seen < few) {
    monitor_.observe(from, to, Support::none, fmt::format("fewer than {} landmarks in view", few));
  } else {
    monitor_.observe(from, to, seen < enough ? Support::weak : Support::full,
                     fmt::format("fewer than {} landmarks in view: the motion prior carries", enough));
  }
  if (!monitor_.lost()) return;
  context_.log(fmt::format("{:.3f} s: lost: {}", monitor_.status().time, monitor_.status().reason));
  // States without data are removed.
  const auto oldest = index(map_->engine.first_state());  // with a lag, older states are marginalised
  while (graph().states.size() > oldest + 2 && graph().states.back().t > monitor_.status().time) {
    map_->engine.remove_newest_state();
  }
}

/// Drops ended tracks that are not landmarks. They had their last chance to become landmarks in the step after their
/// end; before the initial map, in the step that makes it, unless that is much later.
void GpMap::drop_ended_tracks(double t) {
  if (!map_) waiting_.forget_ended_before(t - kMemory);
  std::erase_if(live_, [&](TrackId id) {
    const auto track = tracks_.find(id);
    if (!track->second.ended || (!map_ && !waiting_.observations(id).empty())) return false;
    if (track->second.role == Track::Role::landmark) map_->ended_landmarks.push_back(id);
    if (track->second.role == Track::Role::waiting) {
      waiting_.forget(id);
      tracks_.erase(track);
    }
    return true;
  });
}

/// Between two steps, follows the observations up to t one by one, with a control state at `ahead`, later than all of
/// them.
void GpMap::follow_observations(double t, double ahead) {
  if (!map_ || monitor_.lost()) return;
  const auto start = std::chrono::steady_clock::now();
  take_observations(t);
  if (!map_->new_observations.empty()) map_->follower.open(map_->engine, ahead);
  for (const auto& [landmark, z] : map_->new_observations) {
    map_->follower.follow(map_->engine, landmark, z);
    publish_newest(z.t);
  }
  map_->new_observations.clear();
  seconds_since_step_ += seconds_since(start);
}

/// Counts landmarks whose tracks have been alive since the last step: a track without recent observations has not
/// moved.
int GpMap::landmarks_in_view() const {
  return static_cast<int>(
      std::ranges::count(live_, Track::Role::landmark, [&](TrackId track) { return tracks_.at(track).role; }));
}

void GpMap::add_record(double t, double seconds, int iterations, std::optional<double> cost) {
  UpdateRecord record{t, seconds, 0, 0, 0, iterations, cost};
  if (map_) {
    record.states = static_cast<int>(graph().states.size());
    record.landmarks = map_->tracks;
    record.observations = graph().observation_count();
    const Vector6& qc =
        map_->smoothed_qc && options_.learn.prior == LearnPrior::smoothed ? *map_->smoothed_qc : graph().qc;
    record.estimated = {map_->noise.scale(), map_->noise.share()};
    for (int column = 0; column < 2; ++column) record.estimated.insert(record.estimated.end(), qc.begin(), qc.end());
  }
  updates_.push_back(record);
}

}  // namespace evbench::gp_map
