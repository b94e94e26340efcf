#include "backends/gp_map/modules/initial_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "backends/gp_map/modules/initial_trajectory.hpp"
#include "core/smoother/problem_graph.hpp"
#include "core/support/median.hpp"

namespace evbench::gp_map {
namespace {

constexpr int kViews = 6;
constexpr std::size_t kTracks = 60;  ///< in the views, at most
constexpr int kFirstIterations = 3;  ///< after these, estimates that cost far more than the best one are dropped
constexpr double kFarMore = 1.5;
constexpr double kInitialMapLossWidth = 3.0;  ///< of the loss, in median errors
constexpr int kInitialMapIterations = 10;
constexpr double kMotionGrowth = 1.15;  ///< a new attempt needs this many times the motion of the last one ...
constexpr double kTimeGrowth = 1.5;     ///< ... or time
constexpr double kFarOff = 2.0;         ///< times the allowed error: an outlier
constexpr double kFarthest = 10.0;      ///< [units] largest distance of landmarks of the initial map
constexpr double kNext = 0.15;          ///< [s] in a stationary period, observations this near to a state count
constexpr double kAnchorSigma = 1e-4;   ///< [rad, units] of the gauge: far below the data's, well conditioned

double parallax_deg(const FactorGraph& graph) {
  std::vector<double> angles;
  for (const auto& landmark : graph.landmarks) {
    const Vector3 a = landmark.position - graph.states.front().T.p, b = landmark.position - graph.states.back().T.p;
    angles.push_back(std::atan2(a.cross(b).norm(), a.dot(b)) * kDegrees);
  }
  return median(std::move(angles));
}

/// Evenly spaced from one time to the other, at least this far apart, so that no observation is in two views unless
/// tracks are slow.
std::vector<double> view_times(double from, double to, double apart) {
  const int steps = std::min(kViews - 1, static_cast<int>((to - from) / apart + 1e-9));
  std::vector<double> times;
  for (int i = 0; i <= steps; ++i) times.push_back(from + (to - from) * i / std::max(steps, 1));
  return times;
}

}  // namespace

InitialMapFinder::InitialMapFinder(const Options& options, const PinholeCamera& camera)
    : options_(options), camera_(camera), initialiser_(options.initialiser, camera) {}

std::optional<InitialMap> InitialMapFinder::attempt(const TrackBuffer& tracks, double t) {
  const auto candidates = find_candidates(tracks, t);
  if (!candidates) return std::nullopt;
  const auto found = best_estimate(*candidates);
  if (!found) {
    if (refused_.empty()) refused_ = "no motion explains the tracks";
    return std::nullopt;
  }
  if (!is_sound(*candidates, *found)) return std::nullopt;
  return map_of(tracks, *candidates, *found);
}

std::string InitialMapFinder::reason() const {
  if (refused_.empty() || waiting_.empty()) return refused_ + waiting_;
  return fmt::format("{}; the last attempt, from {:.3f} to {:.3f} s: {}", waiting_, last_->t0, last_->t1, refused_);
}

/// None if there is nothing new.
std::optional<InitialMapFinder::Candidates> InitialMapFinder::find_candidates(const TrackBuffer& tracks, double t) {
  state_times_.push_back(t);
  const TrackMatches matches = initialiser_.match(tracks, t);
  waiting_ = matches.reason;
  if (!matches.reason.empty() || !worthwhile(matches)) return std::nullopt;
  std::vector<double> times = view_times(matches.t0, matches.t1, options_.initialiser.window);
  if (times.size() < 3) {
    waiting_ = fmt::format("{} tracks are seen from {:.3f} to {:.3f} s, {:.3f} s needed", matches.tracks.size(),
                           matches.t0, matches.t1, 2.0 * options_.initialiser.window);
    return std::nullopt;
  }
  last_ = Progress{matches.t0, matches.t1, matches.median_motion()};
  Initialiser::Attempt attempt = initialiser_.solve(matches);
  refused_ = attempt.reason;
  const PlaceWindow window(options_.initialiser.window, matches.or_nearest);
  TrackViews views = TrackViews::of(tracks, std::move(times), window, kTracks);
  return Candidates{MultiView(std::move(views), camera_), std::move(attempt.candidates), window};
}

/// Have the tracks moved, and farther or for longer than at the last attempt from this first view?
bool InitialMapFinder::worthwhile(const TrackMatches& matches) {
  const double motion = matches.median_motion();
  const double enough = 2.0 * options_.initialiser.two_view.threshold_px;
  if (motion < enough) {
    waiting_ = fmt::format("the tracks have moved by {:.1f} px from {:.3f} to {:.3f} s, {:.1f} needed", motion,
                           matches.t0, matches.t1, enough);
    return false;
  }
  if (!last_ || last_->t0 != matches.t0) return true;
  return motion >= kMotionGrowth * last_->motion || matches.t1 - matches.t0 >= kTimeGrowth * (last_->t1 - last_->t0);
}

/// The best estimate of all candidates. The width of the loss follows the noise of the best one after the first
/// iterations.
std::optional<ViewsEstimate> InitialMapFinder::best_estimate(const Candidates& candidates) const {
  const double wide = 2.0 * options_.initialiser.two_view.threshold_px;
  std::vector<ViewsEstimate> trials;
  for (const InitialGuess& guess : candidates.guesses) {
    auto trial = candidates.views.start(guess, wide);
    if (!trial) continue;
    candidates.views.refine(*trial, wide, kFirstIterations);
    trials.push_back(std::move(*trial));
  }
  if (trials.empty()) return std::nullopt;
  std::ranges::sort(trials, {}, &ViewsEstimate::cost);
  const double width = kInitialMapLossWidth * median(candidates.views.errors(trials.front())),
               enough = kFarMore * trials.front().cost;
  std::erase_if(trials, [&](const ViewsEstimate& trial) { return trial.cost > enough; });
  for (ViewsEstimate& trial : trials) candidates.views.refine(trial, width, kInitialMapIterations);
  return *std::ranges::min_element(trials, {}, &ViewsEstimate::cost);
}

/// Do the remaining errors and the uncertainty of the structure allow a map? In slow motion views share observations,
/// and errors are correlated over the time in which parallax develops: less uncertainty is allowed then.
bool InitialMapFinder::is_sound(const Candidates& candidates, const ViewsEstimate& estimate) {
  constexpr double kSlow = 0.5;
  const double error = median(candidates.views.errors(estimate)),
               sigma = median(candidates.views.distance_sigmas(estimate));
  const double allowed = (candidates.window.or_nearest ? kSlow : 1.0) * options_.max_initial_uncertainty;
  if (!(error <= options_.max_initial_error)) {
    refused_ = fmt::format("the best initial map leaves {:.2f} px, {:.2g} allowed", error, options_.max_initial_error);
  } else if (!(sigma <= allowed)) {
    refused_ = fmt::format("the structure is uncertain by {:.0f} %, {:.0f} % allowed", 100.0 * sigma, 100.0 * allowed);
  } else {
    return true;
  }
  return false;
}

InitialMap InitialMapFinder::map_of(const TrackBuffer& tracks, const Candidates& candidates,
                                    const ViewsEstimate& estimate) const {
  const MultiView& views = candidates.views;
  InitialTrajectory path(tracks, camera_, options_, candidates.window);
  const std::vector<double> errors = views.errors(estimate), sigmas = views.distance_sigmas(estimate);
  const double certain = median(sigmas);
  std::set<TrackId> anchored;
  for (std::size_t i = 0; i < estimate.points.size(); ++i) {
    if (errors[i] > kFarOff * options_.max_initial_error || estimate.points[i].inverse < 1.0 / kFarthest) continue;
    path.add_landmark(views.views().tracks[i], estimate.points[i]);
    if (sigmas[i] <= certain) anchored.insert(views.views().tracks[i]);
  }
  path.follow_views(estimate.poses, views.views().times, state_times_);

  InitialMap map;
  FactorGraph& graph = map.graph;
  graph.camera = camera_;
  if (options_.prior == PriorKind::singer) graph.motion_prior.rate = options_.prior_rate;
  graph.qc = options_.qc_scale * Eigen::Map<const Vector6>(options_.qc.data());
  graph.loss = RobustLoss(options_.loss, options_.loss_width);
  for (const ControlState& state : path.states()) graph.add_state(state);
  graph.pose_priors.push_back({0, graph.states.front().T, Vector6::Constant(kAnchorSigma)});
  std::vector<bool> stationary(graph.states.size(), false);  // by interval
  for (const double t : path.skipped()) stationary[index(std::max(0, graph.interval_of(t)))] = true;
  std::vector<int> anchors;
  for (const auto& [track, point] : path.landmarks()) {
    map.tracks.push_back(track);
    const int landmark = graph.add_landmark(point.position());
    if (anchored.contains(track)) anchors.push_back(landmark);
    for (const UndistortedObservation& z : tracks.observations(track)) {
      const int k = graph.interval_of(z.t);
      // A stationary period repeats its observations: those near its states are enough.
      const bool counts = k >= 0 && (!stationary[index(k)] || std::min(z.t - graph.states[index(k - 1)].t,
                                                                       graph.states[index(k)].t - z.t) < kNext);
      if (counts) graph.add_observation(landmark, to_observation(z, options_.sigma_scale));
    }
  }
  graph.anchor_scale(graph.states.front().T.p, anchors);
  map.parallax_deg = parallax_deg(graph);
  return map;
}

}  // namespace evbench::gp_map
