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
                                                "asynchronous MAP estimation under a GP prior (Liu et al. 2022)", 27);

constexpr double kEvery = 0.3;     ///< [s] from one learning with hindsight to the next while running
constexpr double kOneSided = 0.1;  ///< [s] what was seen so shortly ago is known from one side
constexpr double kMemory = 10.0;   ///< [s] for which tracks are remembered that ended before there is a map

}  // namespace

GpMap::GpMap(const Options& options, const BackEndContext& context)
    : options_(options),
      context_(context),
      placement_(options.placement),
      initial_map_(options, context.camera),
      information_told_(RobustLoss(options.loss, options.loss_width).information_told()),
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
    remove_outliers();
    extrapolate_state(t);
    add_observations();
    trust_parallax();
    add_landmarks();
    bound_leverage();
    optimise();
    check_reappeared();
    learn();
    reconsider_recent();
    map_->nearly_in_view.reset();
    trust_what_fits();
    if (is_rejected()) {
      reinitialise();
    } else {
      check_support();
      publish_recent(t);
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
    if (track == tracks_.end()) return;
    track->second.ended = true;
    track->second.astray = false;
  };
  in_time_order(
      std::span(pending_.begin(), later), std::span(ending_.begin(), ending_later),
      [&](const TrackObservation& z) { take(z); }, end);
  pending_.erase(pending_.begin(), later);
  ending_.erase(ending_.begin(), ending_later);
}

void GpMap::take(const TrackObservation& z) {
  Track& track = tracks_[z.track];
  if (track.astray) return;
  live_.insert(z.track);
  if (track.role == Track::Role::landmark) see_landmark(track, z);
  track.ended = false;
  if (track.role == Track::Role::waiting) waiting_.add({&z, 1});
  if (!tentative_.empty()) tentative_.add({&z, 1});
  if (track.role == Track::Role::landmark)
    map_->new_observations.emplace_back(track.landmark, to_observation(z, options_.sigma_scale));
}

/// A landmark that is seen, perhaps again after it had been gone.
void GpMap::see_landmark(Track& track, const TrackObservation& z) {
  constexpr double kGone = 0.05;  // [s] at least
  const std::vector<int>& intervals = graph().landmarks[index(track.landmark)].intervals;
  const int last = intervals.empty() ? 0 : intervals.back();
  const bool reappears = track.ended && last > 0 && z.t - graph().states[index(last)].t > kGone;
  if (!goes_on(track)) {
    split(z.track);
  } else if (reappears && !map_->reappeared.contains(z.track)) {
    map_->reappeared[z.track] = {track.landmark, z.t, z.pixel, last};
  }
}

/// Whether the landmark of a track that is seen now is the one that it was.
bool GpMap::goes_on(const Track& track) {
  if (map_->engine.forgotten(track.landmark)) return false;
  const auto& seen = graph().landmarks[index(track.landmark)].intervals;
  const int newest = static_cast<int>(graph().states.size()) - 1;
  return !track.ended || seen.empty() || seen.back() >= newest || map_->returns.spend(seen.back(), newest + 1);
}

/// A track that came back becomes another landmark, which is expected where the one is that it was; that one stays as
/// what it has been seen to be. What is known of it counts as independent of the motion since.
void GpMap::split(TrackId id) {
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

/// Those of tracks that are landmarks; the others wait in the track buffer until theirs are located.
void GpMap::add_observations() {
  for (const auto& [landmark, z] : map_->new_observations) map_->engine.add_observation(landmark, z);
  map_->new_observations.clear();
}

void GpMap::optimise() {
  map_->last_update = map_->engine.update();
  map_->last_update = map_->aggressive_motion.follow(map_->engine, map_->noise, map_->last_update);
}

/// Prior and noise from what has been seen until now.
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

/// What was seen a while ago is known from both sides: tracks show whether they stayed on their points, and the motion
/// how smooth it was. The newest motion, known from one side alone, keeps a prior that allows for what may come.
void GpMap::learn_from_smoothed(const TimeSpan& span, std::span<const double> surplus) {
  if (!is_tentative()) reject_outliers(map_->noise, span);  // a young map itself is not right yet
  const bool yields = options_.learn.prior != LearnPrior::always && map_->aggressive_motion.is_yielding(graph());
  if (options_.learn.noise && !yields) weigh_tracks(map_->noise, span);
  if (options_.learn.prior == LearnPrior::never) return;
  learn_prior(map_->engine, span, surplus);
  const int k = graph().first_state_after(span.until) - 1;
  if (k > map_->engine.first_state()) map_->smoothed_qc = graph().qcs[index(k)];
}

/// What is seen next is compared with the newest state's constant velocity.
void GpMap::predict_tracks() {
  constexpr double kLargestSpread = 2.0;
  const double noise =
      std::min(kLargestSpread * map_->noise.scale(), map_->noise.scale_of_means()) * options_.sigma_scale;
  placement_.predict([this, noise, newest = graph().states.back()](const TrackObservation& z) {
    std::optional<double> deviation;
    const auto track = tracks_.find(z.track);
    if (track == tracks_.end() || track->second.role != Track::Role::landmark || track->second.astray) return deviation;
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
  if (map_->last_update.unsolvable) {
    monitor_.lose(to, map_->last_update.reason);
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
  const auto oldest = index(map_->engine.first_state());  // with a lag, what is older is settled
  while (graph().states.size() > oldest + 2 && graph().states.back().t > monitor_.status().time) {
    map_->engine.remove_newest_state();
  }
}

/// They had their last chance to become landmarks in the step that saw their end; before the initial map, in the one that
/// makes it, unless that is long after.
void GpMap::forget_ended_tracks(double t) {
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

/// Between two steps, observations up to t are followed one by one, towards a state that stands ahead of them.
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

/// Those whose tracks have been alive since the last step: one that has not been observed of late is where it was.
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
    record.learnt = {map_->noise.scale(), map_->noise.share()};
    for (int column = 0; column < 2; ++column) record.learnt.insert(record.learnt.end(), qc.begin(), qc.end());
  }
  updates_.push_back(record);
}

}  // namespace evbench::gp_map
