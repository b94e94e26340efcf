#include "backends/gp_map/gp_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>

#include "backends/gp_map/problem_graph.hpp"
#include "core/motion/gp_trajectory.hpp"
#include "core/plugin/registry.hpp"
#include "core/structure/depth_reversal.hpp"

namespace evbench::gp_map {
namespace {

const Registration<BackEnd, GpMap> registration("gp_map",
                                                "asynchronous MAP estimation under a GP prior (Liu et al. 2022)");

/// With this many times the parallax that is needed, the cheaper of two first maps is taken, however little cheaper.
constexpr double kDecisiveParallax = 2.0;
constexpr double kInView = 0.05;  ///< [s] since its last observation
constexpr int kInitialIterations = 30;
constexpr double kAnchorSigma = 1e-4;  ///< [rad, units] of the gauge: far below what data tell, well conditioned

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Median angle between the views of a landmark from the first and from the newest control state [deg].
double parallax_deg(const FactorGraph& graph) {
  std::vector<double> angles;
  for (const auto& landmark : graph.landmarks) {
    const Vector3 a = landmark.position - graph.states.front().T.p, b = landmark.position - graph.states.back().T.p;
    angles.push_back(std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / M_PI);
  }
  return median(std::move(angles));
}

}  // namespace

GpMap::GpMap(const Options& options, const BackEndContext& context)
    : options_(options),
      context_(context),
      placement_(options.placement),
      initialiser_(options.initialiser, context.camera),
      health_(options.health) {}

void GpMap::observe(std::span<const TrackObservation> observations) {
  for (const TrackObservation& z : observations) placement_.observe(z.t);
  pending_.insert(pending_.end(), observations.begin(), observations.end());
}

void GpMap::advance(double t) {
  while (const std::optional<double> next = placement_.next(t)) step(*next);
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
    add_landmarks();
    optimise();
    remove_outliers();
    check_health();
  }
  record(t, seconds_since(start));
}

// --- initialisation -----------------------------------------------------------------------------------------------

void GpMap::initialise(double t) {
  state_times_.push_back(t);
  const Initialiser::Attempt attempt = initialiser_.attempt(tracks_, t);
  no_map_reason_ = attempt.reason;
  struct Refined {
    FactorGraph graph;
    const InitialGuess* guess;
    double cost;      // per observation
    double parallax;  // [deg]
  };
  std::vector<Refined> refined;
  for (const InitialGuess& guess : attempt.candidates) {
    auto graph = refine(guess, t);
    if (!graph) continue;
    const auto same = [&](const Refined& other) {  // two guesses that end in one solution are no ambiguity
      return same_motion(other.graph.states.back().T, graph->states.back().T);
    };
    if (std::ranges::any_of(refined, same)) continue;
    const double cost = evaluate(*graph).total() / graph->observation_count();
    const double parallax = parallax_deg(*graph);
    refined.push_back({std::move(*graph), &guess, cost, parallax});
  }
  if (refined.empty()) {
    if (!attempt.candidates.empty()) no_map_reason_ = "the first map does not explain the observations";
    return;
  }
  std::ranges::sort(refined, {}, &Refined::cost);
  // What two views showed may have been noise; the refined map has seen every observation.
  const double needed = options_.initialiser.two_view.min_parallax_deg;
  if (refined[0].parallax < needed) {
    no_map_reason_ = fmt::format("median parallax {:.2f} deg, {:.2f} needed", refined[0].parallax, needed);
    return;
  }
  if (refined.size() > 1 && refined[1].cost < options_.ambiguity_ratio * refined[0].cost &&
      refined[0].parallax < kDecisiveParallax * needed) {
    no_map_reason_ = "two first maps explain the observations equally well";
    return;
  }
  start_from(std::move(refined[0].graph), *refined[0].guess);
}

/// The whole continuous-time problem over the time of the initialisation, solved from a two-view guess. None when it
/// doesn't explain the data.
std::optional<FactorGraph> GpMap::refine(const InitialGuess& guess, double t) const {
  FactorGraph graph;
  graph.camera = context_.camera;
  graph.qc = options_.qc_scale * Eigen::Map<const Vector6>(options_.qc.data());
  graph.loss = RobustLoss(options_.loss, options_.loss_width);
  // Constant velocity between the two views, and before the first where its tracks were seen already.
  const Vector6 velocity = se3::log(guess.T1) / (guess.t1 - guess.t0);
  const ControlState view0{guess.t0, SE3{}, velocity};
  auto first = std::upper_bound(state_times_.begin(), state_times_.end(), start_time(guess) + 1e-9);
  if (first != state_times_.begin()) --first;
  for (auto time = first; time != state_times_.end(); ++time) {
    graph.add_state(extrapolate(view0, *time - guess.t0));
  }
  if (graph.states.size() < 2 || graph.states.back().t != t) return std::nullopt;
  graph.pose_priors.push_back({0, graph.states.front().T, Vector6::Constant(kAnchorSigma)});
  std::vector<int> anchors;
  for (const Landmark& landmark : guess.landmarks) {
    anchors.push_back(graph.add_landmark(landmark.position));
    for (const TrackObservation& z : tracks_.observations(landmark.track)) {
      graph.add_observation(anchors.back(), observation(z));
    }
  }
  graph.anchor_scale(graph.states.front().T.p, anchors);
  if (graph.observation_count() == 0) return std::nullopt;
  Engine engine(std::move(graph), {});
  engine.optimise(kInitialIterations, 1e-6);
  graph = engine.graph();
  std::vector<double> errors;
  for (std::size_t j = 0; j < graph.landmarks.size(); ++j) {
    errors.push_back(reprojection_mean(graph, static_cast<int>(j)));
  }
  if (!(median(errors) <= options_.max_initial_error)) return std::nullopt;
  return graph;
}

/// The time from which on the guess's landmarks suffice for states, at most as long before its first view as the second
/// one is after it.
double GpMap::start_time(const InitialGuess& guess) const {
  std::vector<double> seen_from;
  for (const Landmark& landmark : guess.landmarks) {
    const auto observations = tracks_.observations(landmark.track);
    if (!observations.empty()) seen_from.push_back(observations.front().t);
  }
  const auto enough = static_cast<std::size_t>(options_.health.min_landmarks);
  if (seen_from.size() < enough) return guess.t0;
  std::ranges::sort(seen_from);
  return std::clamp(seen_from[enough - 1], 2.0 * guess.t0 - guess.t1, guess.t0);
}

void GpMap::start_from(FactorGraph first_map, const InitialGuess& guess) {
  engine_.emplace(std::move(first_map), EngineOptions{});
  for (std::size_t j = 0; j < guess.landmarks.size(); ++j) {
    landmark_of_[guess.landmarks[j].track] = static_cast<int>(j);
    track_of_.push_back(guess.landmarks[j].track);
  }
  context_.log(
      fmt::format("{:.3f} s: first map: {} landmarks, {} observations, median parallax {:.1f} deg, from {:.3f} s",
                  graph().states.back().t, graph().landmarks.size(), graph().observation_count(),
                  guess.median_parallax_deg, graph().states.front().t));
  remove_outliers();
  add_landmarks();
  optimise();
}

// --- each control state -------------------------------------------------------------------------------------------

void GpMap::extrapolate_state(double t) {
  const ControlState& newest = graph().states.back();
  engine_->add_state(extrapolate(newest, t - newest.t));
}

Observation GpMap::observation(const TrackObservation& z) const {
  return {z.t, z.pixel, 1.0 / (z.sigma * options_.sigma_scale)};
}

/// Observations up to the new control state, no later ones: the estimate at a time depends on what was seen until then.
void GpMap::take_observations(double t) {
  const auto later = std::ranges::upper_bound(pending_, t, {}, &TrackObservation::t);
  recent_.assign(pending_.begin(), later);
  pending_.erase(pending_.begin(), later);
  tracks_.add(recent_);
}

/// Those of tracks that are landmarks; the others wait in the track buffer until theirs are located.
void GpMap::add_observations() {
  for (const TrackObservation& z : recent_) {
    const auto landmark = landmark_of_.find(z.track);
    if (landmark != landmark_of_.end()) engine_->add_observation(landmark->second, observation(z));
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
  for (const TrackId track : tracks_.alive(newest, 0.1)) {
    const auto count = static_cast<int>(tracks_.observations(track).size());
    if (landmark_of_.contains(track) || count < options_.map.min_observations) continue;
    int& tried_with = tried_with_[track];
    if (!scarce && count < tried_with + options_.map.min_observations / 2) continue;
    tried_with = count;
    const auto place = locate(track, scarce);
    if (!place) continue;
    const int landmark = engine_->add_landmark(place->first, place->second);
    for (const TrackObservation& z : tracks_.observations(track)) {
      engine_->add_observation(landmark, observation(z));
    }
    landmark_of_[track] = landmark;
    track_of_.push_back(track);
    tried_with_.erase(track);
  }
}

/// Where a track's landmark is, by triangulation over its observations; in need (`scarce`), at the scene's depth.
std::optional<std::pair<Vector3, LandmarkPrior>> GpMap::locate(TrackId track, bool scarce) const {
  constexpr std::size_t kViews = 16;  // evenly from all observations: enough for a start
  std::vector<const TrackObservation*> usable;
  for (const TrackObservation& z : tracks_.observations(track)) {
    if (graph().interval_of(z.t) >= 0) usable.push_back(&z);
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

void GpMap::remove_outliers() {
  std::vector<int> seen;
  for (const auto& group : graph().intervals.back().groups()) seen.push_back(group.landmark);
  for (const int landmark : seen) {
    if (reprojection_mean(graph(), landmark) <= options_.map.outlier_threshold) continue;
    const TrackId track = track_of_[static_cast<std::size_t>(landmark)];
    engine_->remove_landmark(landmark);
    landmark_of_.erase(track);
    tracks_.remove(track);
    new_outliers_.push_back(track);
  }
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
  while (graph().states.size() > 2 && graph().states.back().t > health_.status().time) engine_->remove_newest_state();
}

void GpMap::record(double t, double seconds) {
  if (engine_ && graph().states.back().t == t) online_.push_back({t, graph().states.back().T});
  add_record(t, seconds, 1, {});
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

// --- the end ------------------------------------------------------------------------------------------------------

void GpMap::finish() {
  if (const std::optional<double> last = placement_.last()) step(*last);
  if (!engine_) {
    health_.fail(state_times_.empty() ? 0.0 : state_times_.back(),
                 no_map_reason_.empty() ? "no observations" : "no first map: " + no_map_reason_);
    return;
  }
  if (options_.final_iterations == 0) return;
  const auto start = std::chrono::steady_clock::now();
  const Engine::OptimiseSummary summary = engine_->optimise(options_.final_iterations, 1e-7);
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
  if (!engine_) return std::nullopt;
  return to_problem(graph());
}

}  // namespace evbench::gp_map
