#include "spline_map.hpp"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <evbench/plugin.hpp>

#include "cost_functions.hpp"

namespace spline_map {
namespace {

using evbench::TrackId;
using evbench::UndistortedObservation;
using Support = evbench::TrackingMonitor::Support;

const evbench::Registration<evbench::BackEnd, SplineMap> registration(
    "spline_map", "continuous time with a cubic B-spline over a sliding window (Mueggler et al. 2018)");

constexpr double kLongestSilence = 0.2;  // [s] without observations, after which the motion model carries the estimate
constexpr double kAlive = 0.1;           // [s] after its last observation a track may still become a landmark
constexpr double kBetweenTries = 0.1;    // [s] between two attempts to locate a track
constexpr int kFinalRounds = 3;          // of solving and removing outliers
constexpr double kSmallestStep = 1e-6;   // [s]

}  // namespace

SplineMap::SplineMap(const Options& options, const evbench::BackEndContext& context)
    : options_(options), context_(context), initial_map_(options, context_.camera), monitor_(context.patience) {
  FLAGS_minloglevel = google::GLOG_ERROR;  // Ceres' warnings are in its summaries, not for the console
}

void SplineMap::advance(const evbench::UndistortedBatch& batch) {
  for (const UndistortedObservation& z : batch.observations) {
    if (!first_update_) first_update_ = z.t;
    pending_.push_back(z);
  }
  ending_.insert(ending_.end(), batch.ended.begin(), batch.ended.end());
  until_ = batch.until;
  while (first_update_ && !monitor_.lost()) {
    const double t = *first_update_ + static_cast<double>(updates_made_) * options_.update_period;
    if (t > until_) break;
    ++updates_made_;
    update(t);
  }
}

/// Uses only observations up to t, so that the estimate at a time is causal.
void SplineMap::update(double t) {
  const auto start = std::chrono::steady_clock::now();
  take_observations(t);
  SolveReport report;
  if (!mapped_) {
    initialise(t);
  } else {
    const double from = newest_;
    spline_.extend_to(t);
    newest_ = t;
    report = optimise(t);
    remove_outliers(t - options_.window);
    add_landmarks(t);
    watch(from, t);
  }
  if (mapped_ && !monitor_.lost()) context_.publish({{t, spline_.pose(t)}, t});
  updates_.push_back({t, evbench::seconds_since(start), report.knots, report.landmarks, report.observations,
                      report.iterations, report.usable ? std::optional(report.cost) : std::nullopt});
}

void SplineMap::take_observations(double t) {
  for (; !pending_.empty() && pending_.front().t <= t; pending_.pop_front()) {
    const UndistortedObservation& z = pending_.front();
    live_.insert(z.track);
    const auto landmark = landmarks_.find(z.track);
    if (landmark == landmarks_.end()) {
      tracks_.add({&z, 1});
    } else if (z.pixel.allFinite()) {
      landmark->second.observations.push_back(z);
      observed_ = z.t;
    }
  }
  for (; !ending_.empty() && ending_.front().t <= t; ending_.pop_front()) live_.erase(ending_.front().track);
}

void SplineMap::initialise(double t) {
  std::optional<InitialMap> first = initial_map_.attempt(tracks_, t);
  if (!first) return;
  mapped_ = true;
  spline_ = std::move(first->spline);
  landmarks_ = std::move(first->landmarks);
  gauge_ = first->gauge;
  observed_ = newest_ = t;
  for (auto& [track, landmark] : landmarks_) {
    landmark.observations = observations_of(track);
    tracks_.forget(track);
  }
  context_.event({t, "initialised",
                  fmt::format("initial map: {} landmarks, median parallax {:.1f} deg, from {:.3f} s", landmarks_.size(),
                              first->parallax_deg, spline_.start())});
  spline_.extend_to(t);
  remove_outliers(spline_.start());
  add_landmarks(t);
}

SolveReport SplineMap::optimise(double t) {
  const double from = t - options_.window;
  SolveScope scope;
  while (scope.first_knot + 4 < spline_.knots().size() && spline_.knot_time(scope.first_knot + 1) < from) {
    ++scope.first_knot;
  }
  if (spline_.knot_time(0) >= from) scope.first_knot = 0;
  scope.held_from = std::max(spline_.start(), from - options_.held_window);
  const SolveReport report = solve(spline_, landmarks_, options_.densities(spline_, t - options_.update_period),
                                   context_.camera, gauge_, scope, options_.solver(options_.iterations, 1e-4));
  return report;
}

void SplineMap::add_landmarks(double t) {
  const auto known = std::ranges::count_if(live_, [&](TrackId track) { return landmarks_.contains(track); });
  const double needed = known < 2 * options_.min_landmarks ? 0.0 : options_.min_track_time;
  for (const TrackId track : tracks_.alive(t, kAlive)) {
    const auto observations = tracks_.observations(track);
    if (std::ssize(observations) < options_.min_observations) continue;
    if (observations.back().t - observations.front().t < needed) continue;
    const auto tried = tried_at_.find(track);
    if (tried != tried_at_.end() && t - tried->second < kBetweenTries) continue;
    const evbench::Triangulation result =
        triangulate_track(observations, spline_, context_.camera, options_.triangulation);
    if (result.ok()) {
      add_landmark(track, result.point);
    } else {
      tried_at_[track] = t;
    }
  }
}

/// The observations that the spline covers.
std::vector<UndistortedObservation> SplineMap::observations_of(TrackId track) const {
  const auto all = tracks_.observations(track);
  return {std::ranges::lower_bound(all, spline_.start(), {}, &UndistortedObservation::t), all.end()};
}

void SplineMap::add_landmark(TrackId track, const Vector3& position) {
  landmarks_.emplace(track, MappedTrack{position, observations_of(track)});
  tracks_.forget(track);
  tried_at_.erase(track);
}

/// Removes the outliers among the landmarks seen since a time. One that fits after a new triangulation is moved
/// instead.
void SplineMap::remove_outliers(double since) {
  evbench::TriangulationOptions relaxed = options_.triangulation;
  relaxed.min_parallax_deg = 0.1;
  std::vector<TrackId> outliers;
  for (auto& [track, landmark] : landmarks_) {
    if (landmark.observations.empty() || landmark.observations.back().t < since) continue;
    if (mean_error(landmark, spline_, context_.camera) <= options_.outlier_px) continue;
    const evbench::Triangulation again = triangulate_track(landmark.observations, spline_, context_.camera, relaxed);
    if (again.ok()) landmark.position = again.point;
    if (again.ok() && mean_error(landmark, spline_, context_.camera) <= options_.outlier_px) continue;
    outliers.push_back(track);
  }
  for (const TrackId track : outliers) {
    landmarks_.erase(track);
    tracks_.remove(track);
    new_outliers_.push_back(track);
  }
}

/// Reports the support of the estimate. A live track without recent observations is at its last position, but if no
/// track has recent observations, nothing is known.
void SplineMap::watch(double from, double t) {
  const auto seen = std::ranges::count_if(landmarks_, [&](const auto& entry) {
    const auto& [track, landmark] = entry;
    return live_.contains(track) || (!landmark.observations.empty() && landmark.observations.back().t > from);
  });
  if (t - observed_ > kLongestSilence) {
    monitor_.observe(std::min(from, observed_), t, Support::none, "no observations");
  } else if (seen < options_.lost_landmarks) {
    monitor_.observe(from, t, Support::none, fmt::format("fewer than {} landmarks in view", options_.lost_landmarks));
  } else {
    monitor_.observe(from, t, seen < options_.min_landmarks ? Support::weak : Support::full,
                     fmt::format("fewer than {} landmarks in view", options_.min_landmarks));
  }
  const SE3 T = spline_.pose(t);
  if (!T.p.allFinite() || !T.q.coeffs().allFinite()) monitor_.lose(from, "the estimate is not finite");
  if (monitor_.lost()) lose();
}

/// Drops the part of the estimate that no data support.
void SplineMap::lose() {
  newest_ = std::clamp(monitor_.status().time, spline_.start(), newest_);
  spline_.cut(newest_);
  for (auto& [track, landmark] : landmarks_) {
    std::erase_if(landmark.observations, [&](const UndistortedObservation& z) { return z.t > newest_; });
  }
}

void SplineMap::finish() {
  const bool more = !pending_.empty() && pending_.back().t > newest_;
  if (more && !monitor_.lost()) update(pending_.back().t);
  if (!mapped_) {
    monitor_.fail(until_, "no initial map: " + initial_map_.reason());
    return;
  }
  if (options_.final_iterations > 0) solve_everything();
}

/// Triangulates tracks that ended too early, with the improved final estimate.
void SplineMap::locate_the_rest() {
  for (const TrackId track : tracks_.ids()) {
    const auto observations = tracks_.observations(track);
    if (std::ssize(observations) < options_.min_observations || observations.back().t > newest_) continue;
    if (observations.back().t - observations.front().t < options_.min_track_time) continue;
    const auto result = triangulate_track(observations, spline_, context_.camera, options_.triangulation);
    if (result.ok()) add_landmark(track, result.point);
  }
}

void SplineMap::solve_everything() {
  const auto start = std::chrono::steady_clock::now();
  SolveReport report;
  for (int round = 0; round < kFinalRounds; ++round) {
    if (round == 1) locate_the_rest();
    report = solve(spline_, landmarks_, options_.densities(spline_, newest_), context_.camera, gauge_,
                   {0, spline_.start()}, options_.solver(options_.final_iterations, 1e-6));
    remove_outliers(spline_.start());
  }
  context_.log(fmt::format("final estimate: cost {:.2f}, {} observations, {} landmarks, {} knots, {} iterations",
                           report.cost, report.observations, report.landmarks, report.knots, report.iterations));
  updates_.push_back({newest_, evbench::seconds_since(start), report.knots, report.landmarks, report.observations,
                      report.iterations, report.cost});
}

evbench::BackEndFeedback SplineMap::feedback(const evbench::FeedbackNeeds& needs) {
  evbench::BackEndFeedback result;
  result.state =
      monitor_.lost() || !mapped_ ? monitor_.state() : std::max(monitor_.state(), evbench::TrackingState::tracking);
  result.outliers.swap(new_outliers_);
  if (!mapped_) return result;
  result.newest = spline_.state(newest_);
  if (!needs.expected) return result;
  const SE3 now = result.newest->T * evbench::se3::exp((until_ - newest_) * result.newest->velocity);
  for (const auto& [track, landmark] : landmarks_) {
    const Vector3 local = now.inverse() * landmark.position;
    if (!live_.contains(track) || !(local.z() > 0.0)) continue;
    result.expected.push_back(
        {track, landmark.position, context_.camera.project(local), prediction_covariance(landmark, now)});
  }
  return result;
}

/// Covariance from the landmark's uncertainty alone, seen from T: with fixed poses and the newest observations only.
Eigen::Matrix2d SplineMap::prediction_covariance(const MappedTrack& landmark, const SE3& T) const {
  constexpr std::size_t kMost = 50;
  const auto& all = landmark.observations;
  Matrix3 information = 1e-9 * Matrix3::Identity();
  for (std::size_t i = all.size() > kMost ? all.size() - kMost : 0; i < all.size(); ++i) {
    double jacobian[6], residual[2];
    double* blocks[] = {jacobian};
    const double* position = landmark.position.data();
    HeldReprojectionCost(spline_.pose(all[i].t), all[i], context_.camera).Evaluate(&position, residual, blocks);
    const Eigen::Map<const Eigen::Matrix<double, 2, 3, Eigen::RowMajor>> J(jacobian);
    information += J.transpose() * J;
  }
  const Matrix3 Rt = T.R().transpose();
  const evbench::Matrix23 J = context_.camera.project_jacobian(Rt * (landmark.position - T.p)) * Rt;
  return J * information.inverse() * J.transpose();
}

evbench::PoseTrajectory SplineMap::trajectory() const {
  if (!mapped_) return {};
  std::vector<evbench::StampedPose> poses;
  const double start = spline_.start();
  for (long k = 0;; ++k) {
    const double t = start + static_cast<double>(k) * options_.update_period;
    if (t > newest_ - kSmallestStep) break;
    poses.push_back({t, spline_.pose(t)});
  }
  poses.push_back({newest_, spline_.pose(newest_)});
  return evbench::PoseTrajectory(std::move(poses), "spline");
}

std::optional<SE3> SplineMap::pose(double t) const { return covers(t) ? std::optional(spline_.pose(t)) : std::nullopt; }

std::optional<Vector6> SplineMap::velocity(double t) const {
  return covers(t) ? std::optional(spline_.state(t).velocity) : std::nullopt;
}

std::vector<evbench::Landmark> SplineMap::map() const {
  std::vector<evbench::Landmark> result;
  for (const auto& [track, landmark] : landmarks_) result.push_back({track, landmark.position});
  return result;
}

}  // namespace spline_map
