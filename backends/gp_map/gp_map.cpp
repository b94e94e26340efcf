#include "backends/gp_map/gp_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>
#include <utility>

#include "backends/gp_map/problem_graph.hpp"
#include "core/geometry/so3.hpp"
#include "core/motion/gp_trajectory.hpp"
#include "core/motion/wnoa.hpp"
#include "core/plugin/registration.hpp"
#include "core/support/median.hpp"

namespace evbench::gp_map {
namespace {

const Registration<BackEnd, GpMap> registration("gp_map",
                                                "asynchronous MAP estimation under a GP prior (Liu et al. 2022)");

constexpr double kMemory = 1.0;  ///< [s] for which tracks are remembered that ended before there is a map

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

GpMap::GpMap(const Options& options, const BackEndContext& context)
    : options_(options),
      context_(context),
      placement_(options.placement),
      first_map_(options, context.camera),
      monitor_(context.patience) {}

void GpMap::advance(const TrackBatch& batch) {
  for (const TrackObservation& z : batch.observations) placement_.observe(z);
  pending_.insert(pending_.end(), batch.observations.begin(), batch.observations.end());
  ending_.insert(ending_.end(), batch.ended.begin(), batch.ended.end());
  until_ = batch.until;
  while (const std::optional<double> next = placement_.next(until_)) step(*next);
  if (options_.per_observation) follow(until_);
}

void GpMap::step(double t) {
  if (monitor_.lost()) return;
  const auto start = std::chrono::steady_clock::now();
  take_observations(t);
  if (!engine_) {
    initialise(t);
  } else {
    extrapolate_state(t);
    add_observations();
    followed_.clear();
    add_landmarks();
    optimise();
    remove_outliers();
    check_support();
  }
  forget_ended_tracks(t);
  record(t, std::exchange(seconds_since_step_, 0.0) + seconds_since(start));
}

/// Per-observation mode: the newest state stands ahead of the data, and it and the one before follow each observation.
void GpMap::follow(double t) {
  if (!engine_ || monitor_.lost()) return;
  const auto start = std::chrono::steady_clock::now();
  take_observations(t);
  if (!recent_.empty()) extrapolate_state(placement_.upcoming());
  add_observations();
  seconds_since_step_ += seconds_since(start);
}

void GpMap::initialise(double t) {
  if (auto map = first_map_.attempt(tracks_, t)) start_from(std::move(*map));
}

void GpMap::start_from(FirstMap map) {
  EngineOptions engine;
  engine.lag = options_.lag;
  engine_.emplace(std::move(map.graph), engine);
  for (const TrackId track : map.tracks) become_landmark(track, static_cast<int>(track_of_.size()));
  context_.log(
      fmt::format("{:.3f} s: first map: {} landmarks, {} observations, median parallax {:.1f} deg, from {:.3f} s",
                  graph().states.back().t, graph().landmarks.size(), graph().observation_count(), map.parallax_deg,
                  graph().states.front().t));
  remove_outliers();
  add_landmarks();
  optimise();
}

/// In per-observation mode a state stands ahead already, and elsewhere if its time was not known beforehand: then it is
/// taken back, and what was observed is added again.
void GpMap::extrapolate_state(double t) {
  if (graph().states.back().t == t) return;
  const bool elsewhere = graph().states.back().t > t;
  if (elsewhere) engine_->remove_newest_state();
  const ControlState& newest = graph().states.back();
  engine_->add_state(extrapolate(newest, t - newest.t));
  if (!elsewhere) return;
  for (const TrackObservation& z : followed_) {
    engine_->add_observation(landmark_of_.at(z.track), to_observation(z, options_.sigma_scale));
  }
}

/// Observations up to the new control state, no later ones: the estimate at a time depends on what was seen until then.
void GpMap::take_observations(double t) {
  const auto later = std::ranges::upper_bound(pending_, t, {}, &TrackObservation::t);
  recent_.assign(pending_.begin(), later);
  pending_.erase(pending_.begin(), later);
  for (const TrackObservation& z : recent_) {
    live_.insert(z.track);
    if (!landmark_of_.contains(z.track)) tracks_.add({&z, 1});
  }
  for (; !ending_.empty() && ending_.front().t <= t; ending_.pop_front()) {
    live_.erase(ending_.front().track);
    ended_.insert(ending_.front().track);
  }
}

/// They had their last chance to become landmarks in the step that saw their end; before the first map, in the one that
/// makes it, unless that is long after.
void GpMap::forget_ended_tracks(double t) {
  if (!engine_) {
    tracks_.forget_ended_before(t - kMemory);
    return;
  }
  for (const TrackId track : ended_) {
    tracks_.forget(track);
    tried_with_.erase(track);
  }
  ended_.clear();
}

/// Those of tracks that are landmarks; the others wait in the track buffer until theirs are located.
void GpMap::add_observations() {
  for (const TrackObservation& z : recent_) {
    const auto landmark = landmark_of_.find(z.track);
    if (landmark == landmark_of_.end()) continue;
    const Observation observation = to_observation(z, options_.sigma_scale);
    if (engine_->forgotten(landmark->second)) {  // the track becomes another landmark
      landmark_of_.erase(landmark);
      tracks_.add({&z, 1});
    } else if (options_.per_observation) {
      engine_->observe(landmark->second, observation);
      followed_.push_back(z);
      tell_online(z.t);
    } else {
      engine_->add_observation(landmark->second, observation);
    }
  }
}

/// Those whose tracks have been alive since the last step: one that has not been observed of late is where it was.
int GpMap::landmarks_in_view() const {
  const auto is_landmark = [&](TrackId track) { return landmark_of_.contains(track); };
  return static_cast<int>(std::ranges::count_if(live_, is_landmark) + std::ranges::count_if(ended_, is_landmark));
}

void GpMap::add_landmarks() {
  const bool scarce = landmarks_in_view() < 2 * options_.health.min_landmarks;
  for (const TrackId track : tracks_.ids()) {
    const auto count = static_cast<int>(tracks_.observations(track).size());
    if (count < options_.map.min_observations) continue;
    int& tried_with = tried_with_[track];
    if (!scarce && count < tried_with + options_.map.min_observations / 2) continue;
    tried_with = count;
    const auto place = locate(track, scarce);
    if (!place) continue;
    const int landmark = engine_->add_landmark(place->first, place->second);
    for (const TrackObservation& z : tracks_.observations(track)) {
      engine_->add_observation(landmark, to_observation(z, options_.sigma_scale));
    }
    become_landmark(track, landmark);
  }
}

void GpMap::become_landmark(TrackId track, int landmark) {
  landmark_of_[track] = landmark;
  track_of_.push_back(track);
  tried_with_.erase(track);
  tracks_.forget(track);
}

/// Where a track's landmark is, by triangulation over its observations; in need (`scarce`), at the scene's depth.
std::optional<std::pair<Vector3, LandmarkPrior>> GpMap::locate(TrackId track, bool scarce) const {
  constexpr std::size_t kViews = 16;  // evenly from all observations: enough for a start
  std::vector<const TrackObservation*> usable;
  for (const TrackObservation& z : tracks_.observations(track)) {
    if (graph().interval_of(z.t) > engine_->first_state()) usable.push_back(&z);
  }
  if (usable.size() < 2) return std::nullopt;
  std::vector<SE3> poses;
  std::vector<Vector2> pixels;
  const std::size_t views = std::min(kViews, usable.size());
  for (std::size_t i = 0; i < views; ++i) {
    const TrackObservation& z = *usable[i * (usable.size() - 1) / (views - 1)];
    poses.push_back(*pose(z.t));
    pixels.push_back(z.pixel);
  }
  const Triangulation result = triangulate(poses, pixels, context_.camera, options_.map.triangulation);
  if (result.ok()) return std::pair{result.point, LandmarkPrior{}};
  const bool waited = usable.back()->t - usable.front()->t >= options_.map.patience;
  if (!scarce || !waited || result.state != Triangulation::State::low_parallax) return std::nullopt;
  const double depth = median_depth();
  const Vector3 point = poses.back() * (depth * graph().camera.ray(pixels.back()));
  return std::pair{point, LandmarkPrior{point, options_.map.depth_sigma * depth}};
}

/// Of the landmarks seen last, from the newest pose.
double GpMap::median_depth() const {
  const SE3 T_camera_world = graph().states.back().T.inverse();
  std::vector<double> depths;
  for (std::size_t k = graph().intervals.size(); k-- > 0 && depths.size() < 10;) {
    for (const auto& group : graph().intervals[k].groups()) {
      const double z = (T_camera_world * graph().landmarks[static_cast<std::size_t>(group.landmark)].position).z();
      if (z > 0.0) depths.push_back(z);
    }
  }
  return depths.empty() ? 1.0 : median(depths);
}

void GpMap::optimise() { last_update_ = engine_->update(); }

/// Of the landmarks seen in the newest interval.
void GpMap::remove_outliers() {
  std::vector<int> seen;
  for (const auto& group : graph().intervals.back().groups()) seen.push_back(group.landmark);
  for (const int landmark : seen) remove_if_outlier(landmark);
}

void GpMap::remove_if_outlier(int landmark) {
  if (reprojection_mean(graph(), landmark) <= options_.map.outlier_threshold) return;
  hold_scale_without(landmark);
  const TrackId track = track_of_[static_cast<std::size_t>(landmark)];
  engine_->remove_landmark(landmark);
  landmark_of_.erase(track);
  tracks_.remove(track);
  new_outliers_.push_back(track);
}

/// One of few landmarks that hold the scale is about to go: those seen now join the others, at the scale of now.
void GpMap::hold_scale_without(int leaving) {
  std::set<int> anchors(graph().anchor.landmarks.begin(), graph().anchor.landmarks.end());
  if (anchors.erase(leaving) == 0 || std::ssize(anchors) >= options_.health.min_landmarks) return;
  for (const auto& group : graph().intervals.back().groups()) {
    if (group.landmark != leaving) anchors.insert(group.landmark);
  }
  context_.log(fmt::format("{:.3f} s: most landmarks that held the scale were outliers; {} hold it now",
                           graph().states.back().t, anchors.size()));
  engine_->anchor_scale(graph().anchor.origin, {anchors.begin(), anchors.end()});
}

void GpMap::check_support() {
  using Support = TrackingMonitor::Support;
  const std::size_t n = graph().states.size();
  const double from = graph().states[n - 2].t, to = graph().states[n - 1].t;
  const int seen = landmarks_in_view(), enough = options_.health.min_landmarks, few = options_.health.lost_landmarks;
  if (last_update_.rejected && !last_update_.reason.empty()) {
    monitor_.lose(to, last_update_.reason);
  } else if (seen < few) {
    monitor_.observe(from, to, Support::none, fmt::format("fewer than {} landmarks in view", few));
  } else {
    monitor_.observe(from, to, seen < enough ? Support::weak : Support::full,
                     fmt::format("fewer than {} landmarks in view: the motion prior carries", enough));
  }
  if (!monitor_.lost()) return;
  context_.log(fmt::format("{:.3f} s: lost: {}", monitor_.status().time, monitor_.status().reason));
  // What the data never saw is not kept.
  const auto oldest = static_cast<std::size_t>(engine_->first_state());  // with a lag, what is older is settled
  while (graph().states.size() > oldest + 2 && graph().states.back().t > monitor_.status().time) {
    engine_->remove_newest_state();
  }
}

void GpMap::record(double t, double seconds) {
  if (engine_ && graph().states.back().t == t) tell_online(t);
  add_record(t, seconds, 1, {});
}

void GpMap::tell_online(double t) {
  if (t <= online_) return;
  const std::optional<SE3> T = pose(t);
  if (!T) return;
  context_.online({t, *T});
  online_ = t;
}

void GpMap::add_record(double t, double seconds, int iterations, std::optional<double> cost) {
  UpdateRecord record{t, seconds, 0, 0, 0, iterations, cost};
  if (engine_) {
    record.states = static_cast<int>(graph().states.size());
    record.landmarks = static_cast<int>(landmark_of_.size());
    record.observations = graph().observation_count();
  }
  updates_.push_back(record);
}

void GpMap::finish() {
  if (const std::optional<double> last = placement_.last()) step(*last);
  if (!engine_) {
    monitor_.fail(first_map_.newest(),
                  first_map_.reason().empty() ? "no observations" : "no first map: " + first_map_.reason());
    return;
  }
  if (options_.final_iterations == 0 || options_.lag > 0.0) return;
  const auto start = std::chrono::steady_clock::now();
  const auto landmarks = landmark_of_;
  for (const auto& [track, landmark] : landmarks) remove_if_outlier(landmark);
  const Engine::OptimiseSummary summary = engine_->optimise(options_.final_iterations, 1e-9);
  context_.log(fmt::format("final estimate: cost {:.2f} after {:.2f}, {} iterations{}", summary.final_cost,
                           summary.initial_cost, summary.iterations, summary.converged ? "" : ", not converged"));
  add_record(graph().states.back().t, seconds_since(start), summary.iterations, summary.final_cost);
}

Feedback GpMap::feedback(const FeedbackNeeds& needs) {
  Feedback feedback{until_, monitor_.state(), {}, {}, std::exchange(new_outliers_, {}), {}};
  if (!engine_ || monitor_.lost()) return feedback;
  feedback.newest = newest_seen();
  if (needs.covariance) feedback.covariance = covariance(feedback.newest->t);
  if (needs.expected) feedback.expected = expected_features();
  return feedback;
}

/// The newest state, or, where that stands ahead of the data (per-observation mode), the estimate at their end.
ControlState GpMap::newest_seen() const {
  const ControlState& newest = graph().states.back();
  if (newest.t <= until_) return newest;
  return {until_, *pose(until_), *velocity(until_)};
}

/// Landmarks of live tracks, predicted with constant velocity.
std::vector<ExpectedFeature> GpMap::expected_features() {
  constexpr double kNear = 1e-3;  // [units] before the camera: nearer has no image
  const ControlState& newest = graph().states.back();
  const double dt = until_ - newest.t;
  const SE3 motion = se3::exp(dt * newest.velocity), T_camera_world = (newest.T * motion).inverse();
  Eigen::Matrix<double, 6, 12> J_pose;  // of the predicted pose's increment
  J_pose << se3::adjoint(motion.inverse()), dt * se3::right_jacobian(dt * newest.velocity);
  const Matrix6 drift = wnoa::process_covariance(std::abs(dt), graph().qc).topLeftCorner<6, 6>();
  std::vector<ExpectedFeature> result;
  for (const TrackId track : live_) {
    const auto found = landmark_of_.find(track);
    if (found == landmark_of_.end()) continue;
    const Vector3 position = graph().landmarks[static_cast<std::size_t>(found->second)].position;
    const Vector3 point = T_camera_world * position;
    if (point.z() < kNear) continue;
    const Matrix23 J_point = context_.camera.project_jacobian(point);
    Eigen::Matrix<double, 3, 6> point_of_pose;  // T ← T Exp(δ): Rᵀ(l − p) changes by [q]× δφ − δρ
    point_of_pose << so3::hat(point), -Matrix3::Identity();
    const Matrix26 J_image = J_point * point_of_pose;
    const auto covariance =
        engine_->predicted_covariance(found->second, J_image * J_pose, J_point * T_camera_world.R());
    if (!covariance) continue;
    result.push_back(
        {track, position, context_.camera.project(point), *covariance + J_image * drift * J_image.transpose()});
  }
  return result;
}

PoseTrajectory GpMap::trajectory() const {
  std::vector<StampedPose> poses;
  if (!engine_) return {};
  for (const ControlState& state : graph().states) poses.push_back({state.t, state.T});
  return PoseTrajectory(std::move(poses));
}

std::optional<SE3> GpMap::pose(double t) const {
  const int k = engine_ ? graph().interval_of(t) : -1;
  if (k < 0) return std::nullopt;
  const auto index = static_cast<std::size_t>(k);
  return GpInterval(graph().states[index - 1], graph().states[index]).pose(t);
}

std::optional<Vector6> GpMap::velocity(double t) const {
  const int k = engine_ ? graph().interval_of(t) : -1;
  if (k < 0) return std::nullopt;
  const auto index = static_cast<std::size_t>(k);
  return GpInterval(graph().states[index - 1], graph().states[index]).velocity(t);
}

std::optional<Matrix12> GpMap::covariance(double t) { return engine_ ? engine_->covariance(t) : std::nullopt; }

std::vector<Landmark> GpMap::map() const {
  std::vector<Landmark> result;
  for (const auto& [track, landmark] : landmark_of_) {
    result.push_back({track, graph().landmarks[static_cast<std::size_t>(landmark)].position});
  }
  return result;
}

std::optional<Problem> GpMap::problem() const {
  if (!engine_ || options_.lag > 0.0) return std::nullopt;
  return to_problem(graph());
}

}  // namespace evbench::gp_map
