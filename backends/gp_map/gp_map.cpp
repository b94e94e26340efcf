#include "backends/gp_map/gp_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "backends/gp_map/learning.hpp"
#include "core/plugin/registration.hpp"
#include "core/smoother/problem_graph.hpp"
#include "core/support/seconds_since.hpp"

namespace evbench::gp_map {
namespace {

const Registration<BackEnd, GpMap> registration("gp_map",
                                                "asynchronous MAP estimation under a GP prior (Liu et al. 2022)", 30);

constexpr double kMemory = 10.0;  ///< [s] before there is a map, tracks are dropped this long after their end

}  // namespace

GpMap::GpMap(const Options& options, const BackEndContext& context)
    : options_(options),
      context_(context),
      placement_(options.placement),
      initial_map_(options, context.camera),
      tracks_(options.sigma_scale),
      monitor_(context.patience),
      information_share_(RobustLoss(options.loss, options.loss_width).information_share()) {}

void GpMap::advance(const UndistortedBatch& batch) {
  for (const UndistortedObservation& z : batch.observations) placement_.observe(z);
  tracks_.receive(batch);
  until_ = batch.until;
  while (const std::optional<double> next = placement_.next(until_)) {
    if (options_.per_observation) follow_observations(*next, *next);
    step(*next);
  }
  if (options_.per_observation) follow_observations(until_, placement_.upcoming());
}

/// Algorithm 1, for the control state at t.
void GpMap::step(double t) {
  if (monitor_.lost()) return;
  const auto start = std::chrono::steady_clock::now();
  take_observations(t);
  if (map_ || initialise(t)) {
    Estimate& estimate = map_->estimate;
    map_->outliers.reject_newest(estimate, tracks_);
    map_->follower.close(estimate.smoother, t);
    if (estimate.now() < t) estimate.smoother.add_state_at(t);
    for (const auto& [landmark, z] : tracks_.take_observations()) estimate.smoother.add_observation(landmark, z);
    map_->triangulation.drop_guesses(estimate);
    map_->triangulation.add(estimate, tracks_);
    map_->leverage.apply(estimate);
    estimate.update();
    map_->relaxation.relax(estimate);
    map_->reassociation.check(estimate, tracks_);
    learn();
    search_alternatives();
    estimate.end_step();
    map_->check.follow(tracks_, map_->search.is_exhausted());
    check_support();
    publish_recent(t);
    predict_next_state();
  }
  tracks_.drop_ended(t, map_.has_value(), kMemory);
  add_record(t, std::exchange(seconds_since_step_, 0.0) + seconds_since(start), 1, {});
}

void GpMap::take_observations(double t) {
  tracks_.advance_to(
      t, [this](const UndistortedObservation& z) { map_->reassociation.observe(map_->estimate, tracks_, z); });
}

bool GpMap::initialise(double t) {
  auto first = initial_map_.attempt(tracks_.waiting(), t);
  if (!first) return false;
  tracks_.remember();
  map_.emplace(std::move(first->graph), options_, counters_);
  for (std::size_t j = 0; j < first->tracks.size(); ++j) tracks_.become_landmark(first->tracks[j], static_cast<int>(j));
  ++counters_[Count::initial_maps];
  counters_[Count::landmarks] += static_cast<std::int64_t>(first->tracks.size());
  report("initialised",
         fmt::format("initial map: {} landmarks, {} observations, median parallax {:.1f} deg, from {:.3f} s",
                     graph().landmarks.size(), graph().observation_count(), first->parallax_deg,
                     graph().states.front().t));
  return true;
}

/// Estimates prior and noise from the data until now.
void GpMap::learn() {
  Estimate& estimate = map_->estimate;
  if (options_.learn.noise) {
    estimate.noise.follow(graph(), options_.learn.memory);
    estimate.smoother.set_loss(estimate.noise.loss(options_.loss, options_.loss_width));
  }
  map_->prior.follow(estimate);
  if (options_.learn.prior != LearnPrior::always) map_->relaxation.recover(estimate);
  const double now = estimate.now();
  if (now < map_->next_learning) return;
  map_->next_learning = now + options_.learn.interval;
  learn_smoothed(*map_, tracks_, options_, {now - options_.learn.reach, now - options_.learn.newest});
  estimate.update();
}

void GpMap::search_alternatives() {
  if (!map_->estimate.is_tentative() && !map_->search.in_progress()) tracks_.forget_remembered();
  if (const auto other = map_->search.advance(map_->estimate)) adopt(*other);
}

/// Makes another estimate the present one. Tracks that did not fit the wrong one may be landmarks of the right one.
void GpMap::adopt(const AlternativeEstimate& other) {
  constexpr int kSettling = 3;  // updates
  Estimate& estimate = map_->estimate;
  const bool everything = other.first == 0;
  report("hypothesis_accepted", fmt::format("a better alternative estimate of {}, by {:.1f}",
                                            everything ? "everything" : "the recent part", other.advantage));
  other.place_in(estimate.smoother);
  const auto known = static_cast<int>(graph().landmarks.size());
  if (everything) {
    tracks_.recall([this](int landmark) { return graph().landmarks[index(landmark)].alive; });
    estimate.forget_covariances();
    map_->triangulation.add(estimate, tracks_);
  }
  map_->leverage.apply(estimate);
  for (int i = 0; i < kSettling; ++i) estimate.update();
  map_->outliers.reject_since(known, estimate, tracks_);
  map_->recent.reset();
}

void GpMap::check_support() {
  using Support = TrackingMonitor::Support;
  Estimate& estimate = map_->estimate;
  const std::size_t n = graph().states.size();
  const double from = graph().states[n - 2].t, to = graph().states[n - 1].t;
  const int seen = tracks_.landmarks_in_view(), enough = options_.health.min_landmarks,
            few = options_.health.lost_landmarks;
  if (estimate.last_update.unsolvable) {
    monitor_.lose(to, estimate.last_update.reason);
  } else if (to > until_) {
    return;  // the data end, and their tracks with them
  } else if (seen < few) {
    monitor_.observe(from, to, Support::none, fmt::format("fewer than {} landmarks in view", few));
  } else {
    monitor_.observe(from, to, seen < enough ? Support::weak : Support::full,
                     fmt::format("fewer than {} landmarks in view: the motion prior carries", enough));
  }
  if (!monitor_.lost()) return;
  // States without data are removed.
  const auto oldest = index(estimate.smoother.first_state());  // with a lag, older states are marginalised
  while (graph().states.size() > oldest + 2 && graph().states.back().t > monitor_.status().time) {
    estimate.smoother.remove_newest_state();
  }
}

/// Deviations of the next observations from the motion expected of the newest state determine the next control state.
void GpMap::predict_next_state() {
  constexpr double kLargestSpread = 2.0;
  const NoiseLearner& learnt = map_->estimate.noise;
  const double noise = std::min(kLargestSpread * learnt.scale(), learnt.scale_of_means()) * options_.sigma_scale;
  placement_.predict([this, noise, newest = graph().states.back()](const UndistortedObservation& z) {
    std::optional<double> deviation;
    const TrackTable::Track* const track = tracks_.find(z.track);
    if (track == nullptr || track->role != TrackTable::Role::landmark || track->mismatched) return deviation;
    const SE3 T = extrapolate(newest, z.t - newest.t, graph().motion_prior).T;
    const Vector3 point = T.inverse() * graph().landmarks[index(track->landmark)].position;
    if (point.z() > 0.0) {
      deviation = (z.noise.whitening() * Vector2(graph().camera.project(point) - z.pixel)).norm() / noise;
    }
    return deviation;
  });
}

/// Between two steps, follows the observations up to t one by one, with a control state at `ahead`, later than all of
/// them.
void GpMap::follow_observations(double t, double ahead) {
  if (!map_ || monitor_.lost()) return;
  const auto start = std::chrono::steady_clock::now();
  take_observations(t);
  const auto observations = tracks_.take_observations();
  if (!observations.empty()) map_->follower.open(map_->estimate.smoother, ahead);
  for (const auto& [landmark, z] : observations) {
    map_->follower.follow(map_->estimate.smoother, landmark, z);
    publish_newest(z.t);
  }
  seconds_since_step_ += seconds_since(start);
}

void GpMap::finish() {
  const bool had_map = map_.has_value();
  const std::string reason = initial_map_.reason();  // before the last state, which is later than the data
  if (const std::optional<double> last = placement_.last()) step(*last);
  if (!map_) {
    monitor_.fail(std::min(initial_map_.newest(), until_),
                  "no initial map: " + (had_map ? initial_map_.reason() : reason));
    return;
  }
  map_->check.confirm();  // no more data will
  Estimate& estimate = map_->estimate;
  const auto start = std::chrono::steady_clock::now();
  if (options_.final_iterations == 0) {
    estimate.smoother.update_everything();
  } else if (options_.lag > 0.0) {
    estimate_remaining(*map_, tracks_, options_);
    add_record(estimate.now(), seconds_since(start), options_.learn.rounds, {});
  } else {
    const OptimiseSummary summary = estimate_everything(*map_, tracks_, options_);
    report("final_estimate",
           fmt::format("final estimate: cost {:.2f} after {:.2f}, {} iterations{}", summary.final_cost,
                       summary.initial_cost, summary.iterations, summary.converged ? "" : ", not converged"));
    add_record(estimate.now(), seconds_since(start), summary.iterations, summary.final_cost);
    validate_map();
  }
  record_final_prior();
}

/// An estimate that its own data contradict says so. Both halves of a wrong map may agree, though, where most tracks
/// are wrong in the same way.
void GpMap::validate_map() {
  const ValidationOptions& validation = options_.validation;
  if (!validation.enabled || monitor_.lost()) return;
  const std::optional<double> difference = difference_of_halves(graph(), validation);
  if (!difference) return;
  const std::string words = fmt::format("two halves of the map disagree by {:.2g} % of the path", 100.0 * *difference);
  report("validated", "final estimate: " + words);
  if (*difference > validation.disagreement) {
    monitor_.doubt(graph().states.front().t, std::min(map_->estimate.now(), until_), words);
  }
}

BackEndFeedback GpMap::feedback(const FeedbackNeeds& needs) {
  BackEndFeedback feedback;
  feedback.state = monitor_.state();
  if (!map_) return feedback;
  feedback.outliers = tracks_.take_outliers();
  if (monitor_.lost()) return feedback;
  feedback.newest = newest_seen();
  if (needs.covariance) feedback.covariance = covariance(feedback.newest->t);
  if (needs.expected)
    feedback.expected = map_->prediction.expected(map_->estimate, tracks_, until_, placement_.upcoming());
  return feedback;
}

/// The newest state or, if it is ahead of the data (per-observation mode), the estimate at their end.
ControlState GpMap::newest_seen() const {
  const ControlState& newest = graph().states.back();
  if (newest.t <= until_) return newest;
  return {until_, *pose(until_), *velocity(until_)};
}

// While the initial map is not confirmed, no causal pose and no covariance is published: not before the search for an
// alternative estimate on both planes has failed and most tracks fit the map.

void GpMap::publish_newest(double t) {
  const std::optional<SE3> T = pose(t);  // none if the state has been removed
  if (!T || (published_ && t <= *published_) || is_pending()) return;
  context_.publish({{t, *T}, t, velocity(t)});
  published_ = t;
}

/// Publishes the newest state, and the recent ones again: new observations improve them, too.
void GpMap::publish_recent(double t) {
  if (graph().states.back().t != t) return;  // it has been removed
  map_->recent.follow(graph(), map_->estimate.smoother.first_state());
  if (is_pending()) return;
  const auto states = map_->recent.states();
  if (options_.per_observation) {
    publish_newest(t);  // as between the states
  } else {
    context_.publish({{t, states.back().T}, t, states.back().velocity});
    published_ = t;
  }
  for (std::size_t i = states.size() - 1; i-- > 0;) {
    context_.publish({{states[i].t, states[i].T}, t, states[i].velocity});
  }
}

PoseTrajectory GpMap::trajectory() const {
  std::vector<StampedPose> poses;
  if (!map_) return {};
  for (const ControlState& state : graph().states) poses.push_back({state.t, state.T});
  return PoseTrajectory(std::move(poses));
}

std::optional<SE3> GpMap::pose(double t) const { return map_ ? map_->estimate.pose(t) : std::nullopt; }

std::optional<Vector6> GpMap::velocity(double t) const { return map_ ? map_->estimate.velocity(t) : std::nullopt; }

std::optional<Matrix12> GpMap::covariance(double t) {
  if (!map_ || is_pending()) return std::nullopt;
  auto result = map_->estimate.smoother.covariance(t);
  if (result) *result *= information_share_;
  return result;
}

std::optional<Matrix6> GpMap::relative_covariance(double t0, double t1) {
  if (!map_) return std::nullopt;
  const auto state_at = [&](double t) {
    const auto found = std::ranges::lower_bound(graph().states, t, {}, &ControlState::t);
    return static_cast<int>(found - graph().states.begin());
  };
  const int i = state_at(t0), j = state_at(t1);
  const std::optional<Matrix12> joint = map_->estimate.smoother.poses(i, j);
  if (!joint) return std::nullopt;
  const SE3 inverse = graph().states[index(j)].T.inverse() * graph().states[index(i)].T;
  Eigen::Matrix<double, 6, 12> J;  // (T_i Exp δ_i)⁻¹ T_j Exp δ_j = T_i⁻¹ T_j Exp(δ_j − Ad(T_j⁻¹ T_i) δ_i)
  J << -se3::adjoint(inverse), Matrix6::Identity();
  return Matrix6(information_share_ * J * *joint * J.transpose());
}

std::vector<Landmark> GpMap::map() const {
  std::vector<Landmark> result;
  for (const auto& [id, track] : tracks_.all()) {
    if (track.role != TrackTable::Role::landmark && track.role != TrackTable::Role::drifted) continue;
    result.push_back({id, graph().landmarks[index(track.landmark)].position});
  }
  return result;
}

std::vector<std::string> GpMap::estimated_parameters() const {
  std::vector<std::string> names = {"noise_scale", "noise_share"};
  for (const char* when : {"", "final_"}) {
    for (const char* axis :
         {"rotation_x", "rotation_y", "rotation_z", "translation_x", "translation_y", "translation_z"}) {
      names.push_back(fmt::format("{}qc_{}", when, axis));
    }
  }
  return names;
}

std::vector<std::pair<std::string, std::int64_t>> GpMap::counters() const {
  std::vector<std::pair<std::string, std::int64_t>> result;
  for (std::size_t i = 0; i < kCountNames.size(); ++i) {
    result.emplace_back(kCountNames[i], counters_[static_cast<Count>(i)]);
  }
  return result;
}

std::optional<Problem> GpMap::problem() const {
  if (!map_ || options_.lag > 0.0) return std::nullopt;
  return to_problem(graph());
}

void GpMap::report(const char* kind, std::string text) const {
  context_.event({map_->estimate.now(), kind, std::move(text)});
}

/// Adds to the record of each control state's update the final density of the interval that ends there.
void GpMap::record_final_prior() {
  for (UpdateRecord& record : updates_) {
    const int k = graph().interval_of(record.t);
    if (k > 0 && !record.estimated.empty()) std::ranges::copy(graph().qcs[index(k)], record.estimated.end() - 6);
  }
}

void GpMap::add_record(double t, double seconds, int iterations, std::optional<double> cost) {
  UpdateRecord record{t, seconds, 0, 0, 0, iterations, cost};
  if (map_) {
    const NoiseLearner& noise = map_->estimate.noise;
    record.states = static_cast<int>(graph().states.size());
    record.landmarks = tracks_.tracks_with_landmarks();
    record.observations = graph().observation_count();
    const auto& smoothed = map_->prior.smoothed();
    const Vector6& qc = smoothed && options_.learn.prior == LearnPrior::smoothed ? *smoothed : graph().qc;
    record.estimated = {noise.scale(), noise.share()};
    for (int column = 0; column < 2; ++column) record.estimated.insert(record.estimated.end(), qc.begin(), qc.end());
  }
  updates_.push_back(record);
}

}  // namespace evbench::gp_map
