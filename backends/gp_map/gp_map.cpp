#include "backends/gp_map/gp_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>
#include <utility>

#include "backends/gp_map/problem_graph.hpp"
#include "core/motion/gp_trajectory.hpp"
#include "core/plugin/registry.hpp"
#include "core/support/median.hpp"

namespace evbench::gp_map {
namespace {

const Registration<BackEnd, GpMap> registration("gp_map",
                                                "asynchronous MAP estimation under a GP prior (Liu et al. 2022)");

constexpr double kInView = 0.05;  ///< [s] since its last observation
constexpr double kAlive = 0.1;    ///< [s] after its last observation a track may still become a landmark
constexpr double kForget = 1.0;   ///< [s] after its last observation a track that became none is forgotten

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

GpMap::GpMap(const Options& options, const BackEndContext& context)
    : options_(options),
      context_(context),
      placement_(options.placement),
      first_map_(options, context.camera),
      health_(options.health) {}

void GpMap::observe(std::span<const TrackObservation> observations) {
  for (const TrackObservation& z : observations) placement_.observe(z);
  pending_.insert(pending_.end(), observations.begin(), observations.end());
}

void GpMap::advance(double t) {
  while (const std::optional<double> next = placement_.next(t)) step(*next);
  if (options_.per_observation) follow(t);
}

void GpMap::step(double t) {
  if (health_.lost()) return;
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
    check_health();
  }
  record(t, std::exchange(seconds_since_step_, 0.0) + seconds_since(start));
}

/// Per-observation mode: the newest state stands ahead of the data, and it and the one before follow each observation.
void GpMap::follow(double t) {
  if (!engine_ || health_.lost()) return;
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
    if (!landmark_of_.contains(z.track)) tracks_.add({&z, 1});
  }
  tracks_.forget_ended_before(t - kForget);
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
      record_online(z.t);
    } else {
      engine_->add_observation(landmark->second, observation);
    }
  }
}

/// Landmarks observed of late: intervals may be shorter than a track's time between two observations.
int GpMap::landmarks_in_view() const {
  std::set<int> seen;
  const double since = graph().states.back().t - kInView;
  for (std::size_t k = graph().intervals.size(); k-- > 1;) {
    for (const auto& group : graph().intervals[k].groups()) seen.insert(group.landmark);
    if (graph().states[k - 1].t <= since) break;
  }
  return static_cast<int>(seen.size());
}

void GpMap::add_landmarks() {
  const double newest = graph().states.back().t;
  const bool scarce = landmarks_in_view() < 2 * options_.health.min_landmarks;
  for (const TrackId track : tracks_.alive(newest, kAlive)) {
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

void GpMap::check_health() {
  const std::size_t n = graph().states.size();
  if (last_update_.rejected && !last_update_.reason.empty()) {
    health_.lose(graph().states[n - 1].t, last_update_.reason);
  } else {
    health_.observe(graph().states[n - 2].t, graph().states[n - 1].t, landmarks_in_view());
  }
  if (!health_.lost()) return;
  context_.log(fmt::format("{:.3f} s: lost: {}", health_.status().time, health_.status().reason));
  // What the data never saw is not kept.
  const auto unseen = [&](double t) { return t > health_.status().time; };
  const auto oldest = static_cast<std::size_t>(engine_->first_state());  // with a lag, what is older is settled
  while (graph().states.size() > oldest + 2 && unseen(graph().states.back().t)) engine_->remove_newest_state();
  std::erase_if(online_, [&](const StampedPose& pose) { return unseen(pose.t); });
}

void GpMap::record(double t, double seconds) {
  if (engine_ && graph().states.back().t == t) record_online(t);
  add_record(t, seconds, 1, {});
}

void GpMap::record_online(double t) {
  if (online_.empty() || online_.back().t < t) {
    if (const auto T = pose(t)) online_.push_back({t, *T});
  }
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
    health_.fail(first_map_.newest(),
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

Feedback GpMap::feedback() {
  Feedback feedback;
  if (engine_) feedback.newest = graph().states.back();
  feedback.outliers.swap(new_outliers_);
  return feedback;
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

std::optional<Matrix12> GpMap::covariance(double t) const { return engine_ ? engine_->covariance(t) : std::nullopt; }

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
