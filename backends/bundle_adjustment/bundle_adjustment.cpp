#include "backends/bundle_adjustment/bundle_adjustment.hpp"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "backends/bundle_adjustment/pose_refinement.hpp"
#include "core/plugin/registration.hpp"
#include "core/structure/depth_reversal.hpp"
#include "core/support/median.hpp"

namespace evbench::bundle_adjustment {
namespace {

const Registration<BackEnd, BundleAdjustment> registration(
    "bundle_adjustment", "bundle adjustment of batches of observations (the baseline of Liu et al. 2022)", 3);

constexpr double kLongestPrediction = 0.5;  // [s] beyond it, constant velocity predicts nothing
constexpr double kClearlyCheaper = 1.1;  // ratio of two initial guesses' errors from which on the smaller one is taken
constexpr double kParallaxToDecide = 3.0;  // times the least parallax, from which on the smaller one is taken anyway
constexpr int kHeldWindows = 3;            // windows before the optimised one whose sightings hold landmarks in place
constexpr double kShortestSilence = 0.2;   // [s] without observations, after which the estimate is predicted
constexpr int kGlobalRounds = 2;           // of solving and removing outliers
constexpr double kSmallestStep = 1e-6;     // [s] between batches of observations with the same time

std::size_t at(int view) { return static_cast<std::size_t>(view); }

}  // namespace

/// A map from an initial guess, after bundle adjustment over all batches between its two views.
struct BundleAdjustment::Trial {
  Reconstruction map;
  Segment segment;
  SolveReport report;
  double error = 0.0;  ///< mean over the matched tracks of their mean reprojection error, at most outlier_px each
  int good = 0;        ///< landmarks below outlier_px
  double parallax_deg = 0.0;
};

BundleAdjustment::BundleAdjustment(const Options& options, const BackEndContext& context)
    : options_(options),
      context_(context),
      batches_({options.batch_duration, options.batch_observations, options.batch_motion, options.min_batch_duration,
                options.common_noise_px}),
      initialiser_(initialiser_options(), context.camera),
      waiting_for_("no observations"),
      monitor_(context.patience) {
  FLAGS_minloglevel = google::GLOG_ERROR;  // warnings of Ceres are in its summaries
}

/// Means of batches have exactly the batch's time: a window of zero width finds them and nothing else.
InitialiserOptions BundleAdjustment::initialiser_options() const {
  InitialiserOptions result = options_.initialiser;
  result.window = 0.0;
  return result;
}

TriangulationOptions BundleAdjustment::triangulation_options() const {
  TriangulationOptions result;
  result.min_parallax_deg = options_.min_parallax_deg;
  result.max_rms_px = options_.outlier_px;
  return result;
}

SolverOptions BundleAdjustment::solver_options(int iterations) const {
  return {options_.loss, options_.loss_width * noise_factor_, iterations};
}

void BundleAdjustment::advance(const UndistortedBatch& batch) {
  until_ = batch.until;
  in_time_order(
      batch.observations, batch.ended, [&](const UndistortedObservation& z) { live_.insert(z.track); },
      [&](const TrackEnd& ended) { live_.erase(ended.track); });
  for (std::span<const UndistortedObservation> rest(batch.observations); !rest.empty();) {
    const auto last =
        std::ranges::adjacent_find(rest, [](const auto& a, const auto& b) { return b.t - a.t > kShortestSilence; });
    const auto part = rest.first(last == rest.end() ? rest.size() : static_cast<std::size_t>(last - rest.begin()) + 1);
    if (part.front().t - last_observation_ > kShortestSilence) pass_time(part.front().t);
    for (Batch& complete : batches_.add(part)) process(std::move(complete));
    last_observation_ = part.back().t;
    rest = rest.subspan(part.size());
  }
  pass_time(until_);
}

/// Without observations there are no batches. A motion model carries the estimate, for a limited time.
void BundleAdjustment::pass_time(double t) {
  for (Batch& batch : batches_.advance(t)) process(std::move(batch));
  if (segments_.empty() || t - last_observation_ <= kShortestSilence) return;
  monitor_.observe(last_observation_, t, TrackingMonitor::Support::none, "no observations");
}

void BundleAdjustment::process(Batch batch) {
  if (monitor_.lost()) return;
  const auto start = std::chrono::steady_clock::now();
  std::erase_if(batch.keypoints, [&](const Keypoint& keypoint) { return removed_.contains(keypoint.track); });
  if (!map_.views.empty()) batch.t = std::max(batch.t, map_.views.back().t + kSmallestStep);
  const int view = map_.add(batch);
  if (segments_.empty()) remember(view);
  const std::size_t maps = segments_.size();
  const SolveReport report = segments_.empty() ? initialise(view) : track(view);
  if (!segments_.empty()) {
    const int first = segments_.back().first;
    publish_newest(view, segments_.size() > maps ? first : std::max(first, view - options_.window + 1), batch.end);
  }
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  updates_.push_back(
      {batch.t, elapsed.count(), report.poses, report.landmarks, report.observations, report.iterations, report.cost});
}

/// Publishes the newest view first. The others are improved estimates of poses that were published before or, with an
/// initial map, late poses.
void BundleAdjustment::publish_newest(int view, int oldest, double known_at) const {
  const View& newest = map_.views[at(view)];
  context_.publish({{newest.t, newest.T}, known_at, velocity_});
  if (!newest.estimated()) return;
  for (int i = oldest; i < view; ++i) {
    const View& older = map_.views[at(i)];
    if (older.estimated()) context_.publish({{older.t, older.T}, known_at});
  }
}

int BundleAdjustment::view_at(double t) const {
  const auto found = std::lower_bound(map_.views.begin(), map_.views.end(), t,
                                      [](const View& view, double time) { return view.t < time; });
  return static_cast<int>(found - map_.views.begin());
}

BundleAdjustment::Trial BundleAdjustment::try_guess(const InitialGuess& guess, int view) const {
  Trial trial;
  trial.map = map_;
  trial.parallax_deg = guess.median_parallax_deg;
  const int first = view_at(guess.t0);
  trial.segment = {first, view};
  trial.map.cut_tracks(first);
  const SE3 origin = map_.views[at(first)].T;  // identity at the start, a predicted pose later
  const SE3 motion{guess.T1.q, median_depth_ * guess.T1.p};
  for (int i = first; i <= view; ++i) {
    View& v = trial.map.views[at(i)];
    v.T = origin * se3::exp((v.t - guess.t0) / (guess.t1 - guess.t0) * se3::log(motion));
    v.state = View::State::estimated;
  }
  for (const Landmark& landmark : guess.landmarks) {
    trial.map.tracks.at(landmark.track).position = origin * Vector3(median_depth_ * landmark.position);
  }
  trial.report =
      solve(trial.map, context_.camera, {first, first, view, first, view}, solver_options(options_.global_iterations));
  for (const Landmark& landmark : guess.landmarks) {
    const double error = trial.map.mean_error(trial.map.tracks.at(landmark.track), context_.camera);
    trial.error += std::min(error, options_.outlier_px);
    if (error < options_.outlier_px) ++trial.good;
  }
  trial.error += static_cast<double>(guess.outliers.size()) * options_.outlier_px;
  trial.error /= static_cast<double>(guess.landmarks.size() + guess.outliers.size());
  return trial;
}

SolveReport BundleAdjustment::initialise(int view) {
  const double t = map_.views[at(view)].t;
  const Initialiser::Attempt attempt = initialiser_.attempt(means_, t);
  waiting_for_ = attempt.reason;
  std::vector<Trial> trials;
  for (const InitialGuess& guess : attempt.candidates) {
    Trial trial = try_guess(guess, view);
    if (!trial.report.usable || trial.good < options_.initialiser.two_view.min_inliers) continue;
    const auto same = [&](const Trial& other) {  // two guesses that end in one solution are no ambiguity
      return same_motion(other.map.views[at(view)].T, trial.map.views[at(view)].T);
    };
    if (std::any_of(trials.begin(), trials.end(), same)) continue;
    const auto place =
        std::find_if(trials.begin(), trials.end(), [&](const Trial& t2) { return trial.error < t2.error; });
    trials.insert(place, std::move(trial));
  }
  if (trials.empty()) {
    if (!attempt.candidates.empty()) waiting_for_ = "bundle adjustment does not confirm the two-view pose";
    return {};
  }
  const bool clear = trials.size() == 1 || trials[1].error > kClearlyCheaper * trials[0].error ||
                     trials[0].parallax_deg > kParallaxToDecide * options_.initialiser.two_view.min_parallax_deg;
  const SolveReport report = trials.front().report;
  if (clear) {
    accept(std::move(trials.front()), view);
  } else {
    waiting_for_ = fmt::format("two solutions explain the views about as well ({:.3f} px, {:.3f} px)", trials[0].error,
                               trials[1].error);
  }
  return report;
}

void BundleAdjustment::accept(Trial trial, int view) {
  map_ = std::move(trial.map);
  segments_.push_back(trial.segment);
  const double t = map_.views[at(view)].t;
  context_.event({t, "initialised",
                  fmt::format("map from views at {:.3f} s and {:.3f} s, parallax {:.2f} deg, {} landmarks, mean error "
                              "{:.3f} px",
                              map_.views[at(trial.segment.first)].t, t, trial.parallax_deg, trial.good, trial.error)});
  failing_ = false;
  remove_outliers(trial.segment.first);
  map_.triangulate_new(context_.camera, triangulation_options(), {options_.min_track_batches, options_.min_track_time});
  update_motion(view);
}

SE3 BundleAdjustment::predict(double t, int from) const {
  const View& view = map_.views[at(from)];
  return view.T * se3::exp(std::min(t - view.t, kLongestPrediction) * velocity_);
}

SolveReport BundleAdjustment::track(int view) {
  View& now = map_.views[at(view)];
  now.T = predict(now.t, view - 1);
  const std::string failure = locate(view);
  const double before = map_.views[at(view - 1)].t, t = now.t;
  SolveReport report;
  if (failure.empty()) {
    failing_ = false;
    monitor_.observe(before, t, TrackingMonitor::Support::full);
    map_.triangulate_new(context_.camera, triangulation_options(),
                         {options_.min_track_batches, options_.min_track_time});
    report = solve_window(view);
    remove_outliers(view - options_.window);
    update_motion(view);
  } else {
    now.state = View::State::predicted;
    if (!failing_) reset_initialisation();
    remember(view);
    report = initialise(view);
    monitor_.observe(before, t, failing_ ? TrackingMonitor::Support::none : TrackingMonitor::Support::weak, failure);
    if (!failing_) monitor_.recovered(map_.views[at(segments_.back().first)].t);
  }
  return report;
}

/// Locates a view from the landmarks that it sees. Returns why this failed; empty: it did not.
std::string BundleAdjustment::locate(int view) {
  View& now = map_.views[at(view)];
  const std::vector<Keypoint> keypoints = map_.landmarks_in(view);
  if (static_cast<int>(keypoints.size()) < options_.min_landmarks) {
    return fmt::format("{} landmarks in view, {} needed", keypoints.size(), options_.min_landmarks);
  }
  const auto loss = make_loss(options_.loss, options_.loss_width * noise_factor_);
  const PoseEstimate estimate = estimate_pose(now.T, map_, keypoints, context_.camera, loss.get(), options_.outlier_px);
  if (!(estimate.median_px <= 2.0 * options_.outlier_px)) {
    return fmt::format("no pose explains the landmarks (median reprojection error {:.1f} px)", estimate.median_px);
  }
  now.T = estimate.T;
  now.state = View::State::estimated;
  return "";
}

void BundleAdjustment::remember(int view) {
  const View& now = map_.views[at(view)];
  for (const Keypoint& z : now.keypoints) {
    const UndistortedObservation mean{z.track, now.t, z.pixel, z.noise};
    means_.add(std::span(&mean, 1));
  }
}

/// Tracking with the map has failed: another one is searched from this view on.
void BundleAdjustment::reset_initialisation() {
  failing_ = true;
  means_ = TrackBuffer();
  initialiser_ = Initialiser(initialiser_options(), context_.camera);
}

/// Estimates the noise from the residuals of the views from `first` on.
void BundleAdjustment::learn_noise(int first) {
  constexpr double kLeast = 0.1, kMost = 10.0;  // beyond these there are too few residuals, or nothing fits
  if (!options_.learn_noise) return;
  noise_factor_ = std::clamp(map_.noise_factor(context_.camera, first).value_or(noise_factor_), kLeast, kMost);
}

SolveReport BundleAdjustment::solve_window(int view) {
  const Segment& segment = segments_.back();
  const int first_variable = std::max(segment.first, view - options_.window + 1);
  learn_noise(first_variable);
  const int first_used = std::max(segment.first, first_variable - kHeldWindows * options_.window);
  return solve(map_, context_.camera, {first_used, first_variable, view, segment.first, segment.scale},
               solver_options(options_.iterations));
}

bool BundleAdjustment::remove_outliers(int first) {
  const std::vector<TrackId> outliers = map_.outliers(context_.camera, options_.outlier_px, first);
  for (const TrackId id : outliers) {
    map_.remove(id);
    removed_.insert(id);
    new_outliers_.push_back(id);
  }
  return !outliers.empty();
}

/// Velocity and median depth after the view has been estimated, for predictions and for the scale of a new map.
void BundleAdjustment::update_motion(int view) {
  const View& now = map_.views[at(view)];
  if (view > 0 && map_.views[at(view - 1)].estimated()) {
    const View& before = map_.views[at(view - 1)];
    velocity_ = se3::log(before.T.inverse() * now.T) / (now.t - before.t);
  }
  std::vector<double> depths;
  for (const Keypoint& z : map_.landmarks_in(view)) {
    depths.push_back((now.T.inverse() * *map_.tracks.at(z.track).position).z());
  }
  if (depths.empty()) return;
  const double depth = median(depths);
  if (depth > 0.0) median_depth_ = depth;
}

void BundleAdjustment::finish() {
  const std::string reason = waiting_for_;
  const bool had_batches = !map_.views.empty();
  if (std::optional<Batch> batch = batches_.rest()) process(std::move(*batch));
  if (segments_.empty()) {
    if (had_batches) waiting_for_ = reason;  // the rest of a batch has few tracks
    monitor_.fail(map_.views.empty() ? 0.0 : map_.views.back().t, "never initialised: " + waiting_for_);
    return;
  }
  if (options_.global_solve) {
    for (std::size_t i = 0; i < segments_.size(); ++i) {
      const bool newest = i + 1 == segments_.size();
      solve_segment(segments_[i], newest ? static_cast<int>(map_.views.size()) - 1 : segments_[i + 1].first - 1);
    }
  }
  fill_predicted();
}

void BundleAdjustment::solve_segment(const Segment& segment, int last) {
  const auto start = std::chrono::steady_clock::now();
  SolveReport report;
  for (int round = 0; round < kGlobalRounds; ++round) {
    learn_noise(segment.first);
    report = solve(map_, context_.camera, {segment.first, segment.first, last, segment.first, segment.scale},
                   solver_options(options_.global_iterations));
    if (!remove_outliers(segment.first)) break;
  }
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  updates_.push_back({map_.views[at(last)].t, elapsed.count(), report.poses, report.landmarks, report.observations,
                      report.iterations, report.cost});
}

/// Predicted poses between estimated ones are interpolated; those at the end continue with constant velocity.
void BundleAdjustment::fill_predicted() {
  int before = -1;
  for (int i = 0; i < static_cast<int>(map_.views.size()); ++i) {
    if (map_.views[at(i)].estimated()) {
      before = i;
      continue;
    }
    if (map_.views[at(i)].state != View::State::predicted) continue;
    int after = i;
    while (after < static_cast<int>(map_.views.size()) && !map_.views[at(after)].estimated()) ++after;
    View& view = map_.views[at(i)];
    const View& left = map_.views[at(before)];
    if (after == static_cast<int>(map_.views.size())) {
      view.T = predict(view.t, before);
    } else {
      const View& right = map_.views[at(after)];
      const double s = (view.t - left.t) / (right.t - left.t);
      view.T = left.T * se3::exp(s * se3::log(left.T.inverse() * right.T));
    }
  }
}

BackEndFeedback BundleAdjustment::feedback(const FeedbackNeeds& needs) {
  BackEndFeedback result{monitor_.state(), {}, {}, std::exchange(new_outliers_, {}), {}};
  if (segments_.empty() || monitor_.lost()) return result;
  result.newest = ControlState{map_.views.back().t, map_.views.back().T, velocity_};
  if (needs.expected) result.expected = expected_features();
  return result;
}

/// All landmarks, predicted with constant velocity. The uncertainty is not estimated: outlier_px.
std::vector<UndistortedFeature> BundleAdjustment::expected_features() const {
  const SE3 T_camera_world = predict(until_, static_cast<int>(map_.views.size()) - 1).inverse();
  std::vector<UndistortedFeature> result;
  for (const auto& [id, track] : map_.tracks) {
    if (!track.position) continue;
    const Vector3 point = T_camera_world * *track.position;
    if (point.z() <= 0.0) continue;
    result.push_back({id, *track.position, context_.camera.project(point),
                      options_.outlier_px * options_.outlier_px * Matrix2::Identity()});
  }
  return result;
}

PoseTrajectory BundleAdjustment::trajectory() const {
  std::vector<StampedPose> poses;
  for (const View& view : map_.views) {
    if (view.state == View::State::unknown || (monitor_.lost() && view.t > monitor_.status().time)) continue;
    poses.push_back({view.t, view.T});
  }
  return PoseTrajectory(std::move(poses), "estimated trajectory");
}

std::vector<Landmark> BundleAdjustment::map() const {
  std::vector<Landmark> result;
  for (const auto& [id, track] : map_.tracks) {
    if (track.position) result.push_back({id, *track.position});
  }
  return result;
}

}  // namespace evbench::bundle_adjustment
