#include "backends/gp_map/first_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "backends/gp_map/engine/engine.hpp"
#include "backends/gp_map/problem_graph.hpp"
#include "core/structure/depth_reversal.hpp"
#include "core/support/median.hpp"

namespace evbench::gp_map {
namespace {

/// With this many times the parallax that is needed, the cheaper of two first maps is taken, however little cheaper.
constexpr double kDecisiveParallax = 2.0;
constexpr int kIterations = 30;
constexpr double kAnchorSigma = 1e-4;  ///< [rad, units] of the gauge: far below what data tell, well conditioned

double parallax_deg(const FactorGraph& graph) {
  std::vector<double> angles;
  for (const auto& landmark : graph.landmarks) {
    const Vector3 a = landmark.position - graph.states.front().T.p, b = landmark.position - graph.states.back().T.p;
    angles.push_back(std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / M_PI);
  }
  return median(std::move(angles));
}

double median_error_px(const FactorGraph& graph) {
  std::vector<double> errors;
  for (std::size_t j = 0; j < graph.landmarks.size(); ++j) {
    errors.push_back(reprojection_mean(graph, static_cast<int>(j)));
  }
  return median(std::move(errors));
}

}  // namespace

FirstMapFinder::FirstMapFinder(const Options& options, const PinholeCamera& camera)
    : options_(options), camera_(camera), initialiser_(options.initialiser, camera) {}

std::optional<FirstMap> FirstMapFinder::attempt(const TrackBuffer& tracks, double t) {
  state_times_.push_back(t);
  const Initialiser::Attempt attempt = initialiser_.attempt(tracks, t);
  reason_ = attempt.reason;
  std::vector<FirstMap> refined;
  for (const InitialGuess& guess : attempt.candidates) {
    auto map = refine(tracks, guess);
    if (!map) continue;
    const auto same = [&](const FirstMap& other) {  // two guesses that end in one solution are no ambiguity
      return same_motion(other.graph.states.back().T, map->graph.states.back().T);
    };
    if (std::ranges::none_of(refined, same)) refined.push_back(std::move(*map));
  }
  if (refined.empty()) {
    if (!attempt.candidates.empty()) reason_ = "the first map does not explain the observations";
    return std::nullopt;
  }
  std::ranges::sort(refined, {}, &FirstMap::cost);
  // What two views showed may have been noise; the refined map has seen every observation.
  const double needed = options_.initialiser.two_view.min_parallax_deg;
  if (refined[0].parallax_deg < needed) {
    reason_ = fmt::format("median parallax {:.2f} deg, {:.2f} needed", refined[0].parallax_deg, needed);
    return std::nullopt;
  }
  if (refined.size() > 1 && refined[1].cost < options_.ambiguity_ratio * refined[0].cost &&
      refined[0].parallax_deg < kDecisiveParallax * needed) {
    reason_ = "two first maps explain the observations equally well";
    return std::nullopt;
  }
  return std::move(refined[0]);
}

/// The whole continuous-time problem over the time of the initialisation, solved from a two-view guess. None when it
/// doesn't explain the data.
std::optional<FirstMap> FirstMapFinder::refine(const TrackBuffer& tracks, const InitialGuess& guess) const {
  FirstMap map;
  FactorGraph& graph = map.graph;
  graph.camera = camera_;
  graph.qc = options_.qc_scale * Eigen::Map<const Vector6>(options_.qc.data());
  graph.loss = RobustLoss(options_.loss, options_.loss_width);
  // Constant velocity between the two views, and before the first where its tracks were seen already.
  const ControlState view0{guess.t0, SE3{}, se3::log(guess.T1) / (guess.t1 - guess.t0)};
  for (const double time : state_times_from(start_time(tracks, guess))) {
    graph.add_state(extrapolate(view0, time - guess.t0));
  }
  if (graph.states.size() < 2) return std::nullopt;
  graph.pose_priors.push_back({0, graph.states.front().T, Vector6::Constant(kAnchorSigma)});
  std::vector<int> anchors;
  for (const Landmark& landmark : guess.landmarks) {
    map.tracks.push_back(landmark.track);
    anchors.push_back(graph.add_landmark(landmark.position));
    for (const TrackObservation& z : tracks.observations(landmark.track)) {
      graph.add_observation(anchors.back(), to_observation(z, options_.sigma_scale));
    }
  }
  graph.anchor_scale(graph.states.front().T.p, anchors);
  if (graph.observation_count() == 0) return std::nullopt;
  Engine engine(std::move(graph), {});
  engine.optimise(kIterations, 1e-6);
  graph = engine.graph();
  if (!(median_error_px(graph) <= options_.max_initial_error)) return std::nullopt;
  map.cost = evaluate(graph).total() / graph.observation_count();
  map.parallax_deg = parallax_deg(graph);
  return map;
}

/// The last state time at or before `start`, and all after it.
std::vector<double> FirstMapFinder::state_times_from(double start) const {
  auto first = std::upper_bound(state_times_.begin(), state_times_.end(), start + 1e-9);
  if (first != state_times_.begin()) --first;
  return {first, state_times_.end()};
}

/// The time from which on the guess's landmarks suffice for states, at most as long before its first view as the second
/// one is after it.
double FirstMapFinder::start_time(const TrackBuffer& tracks, const InitialGuess& guess) const {
  std::vector<double> seen_from;
  for (const Landmark& landmark : guess.landmarks) {
    const auto observations = tracks.observations(landmark.track);
    if (!observations.empty()) seen_from.push_back(observations.front().t);
  }
  const auto enough = index(options_.health.min_landmarks);
  if (seen_from.size() < enough) return guess.t0;
  std::ranges::sort(seen_from);
  return std::clamp(seen_from[enough - 1], 2.0 * guess.t0 - guess.t1, guess.t0);
}

}  // namespace evbench::gp_map
