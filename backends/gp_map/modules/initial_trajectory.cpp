#include "backends/gp_map/modules/initial_trajectory.hpp"

#include <algorithm>

#include "core/structure/initialiser.hpp"
#include "core/structure/resection.hpp"
#include "core/structure/triangulation.hpp"
#include "core/support/index.hpp"

namespace evbench::gp_map {
namespace {

constexpr double kLongestGap = 1.0;  ///< [s] over which the motion is extrapolated, back to where enough is seen again
constexpr double kStationary = 5.0;  ///< [s] without motion before the first view: a stationary period
constexpr double kStationaryGap = 0.9;  ///< [s] between the states of a stationary period, at most

/// The pose at t, interpolated between views.
SE3 pose_between(std::span<const SE3> views, std::span<const double> times, double t) {
  const auto later = std::ranges::upper_bound(times, t);
  const auto k = std::clamp<std::ptrdiff_t>(later - times.begin(), 1, std::ssize(times) - 1);
  const SE3 &a = views[index(k - 1)], &b = views[index(k)];
  const double share = (t - times[index(k - 1)]) / (times[index(k)] - times[index(k - 1)]);
  return a * se3::exp(share * se3::log(a.inverse() * b));
}

}  // namespace

void InitialTrajectory::follow_views(std::span<const SE3> views, std::span<const double> view_times,
                                     std::span<const double> state_times) {
  first_view_ = view_times.front();
  begins_stationary_ = is_stationary(first_view_ - kStationary);
  const auto first = std::ranges::lower_bound(state_times, first_view_);
  for (auto t = state_times.end(); t != first;) {
    const SE3 guess = pose_between(views, view_times, *--t);
    const Sightings seen = sightings(*t);
    const auto found = resect(guess, seen.points, seen.pixels, camera_, options_.initialiser.two_view.threshold_px);
    states_.push_back({*t, found && found->median_px <= options_.max_initial_error ? found->T : guess});
  }
  for (auto t = first; t != state_times.begin() && states_.back().t - *--t < kLongestGap && extend_back_to(*t);) {
  }
  std::ranges::reverse(states_);
  take_velocities();
}

/// Extends the trajectory back to t. There is no state at t if too little is seen, or if the camera is stationary and
/// the next state is near. False if no pose fits the observations.
bool InitialTrajectory::extend_back_to(double t) {
  if (begins_stationary_ && states_.back().t - t < kStationaryGap && is_stationary(t)) {
    skipped_.push_back(t);
    return true;
  }
  const auto enough = index(options_.health.min_landmarks);
  if (sightings(t).points.size() < 2 * enough) triangulate_at(t);
  const Sightings seen = sightings(t);
  if (seen.points.size() < enough) return true;
  const ControlState &newer = states_[states_.size() - 2], &next = states_.back();
  const double share = (t - next.t) / (newer.t - next.t);
  const SE3 guess = next.T * se3::exp(share * se3::log(next.T.inverse() * newer.T));
  const auto found = resect(guess, seen.points, seen.pixels, camera_, options_.initialiser.two_view.threshold_px);
  if (!found || !(found->median_px <= options_.max_initial_error)) return false;
  states_.push_back({t, found->T});
  return true;
}

/// Is everything in the same place as in the first view?
bool InitialTrajectory::is_stationary(double t) const {
  const TrackMatches since = matches_between(tracks_, first_view_, t, window_);
  if (std::ssize(since.tracks) < options_.health.min_landmarks) return false;
  return since.median_motion() < options_.initialiser.two_view.threshold_px;
}

/// Triangulates the landmarks of tracks that are alive at t, from the states so far.
void InitialTrajectory::triangulate_at(double t) {
  for (const TrackId track : tracks_.alive(t, 0.5 * window_.length)) {
    if (landmarks_.contains(track)) continue;
    std::vector<SE3> poses;
    std::vector<Vector2> pixels;
    for (const ControlState& state : states_) {
      const auto place = tracks_.position(track, state.t, window_);
      if (!place) continue;
      poses.push_back(state.T);
      pixels.push_back(*place);
    }
    const Triangulation point = triangulate(poses, pixels, camera_, options_.map.triangulation);
    if (point.ok()) landmarks_[track] = {point.point.normalized(), 1.0 / point.point.norm()};
  }
}

InitialTrajectory::Sightings InitialTrajectory::sightings(double t) const {
  Sightings result;
  for (const auto& [track, point] : landmarks_) {
    const auto place = tracks_.position(track, t, window_);
    if (!place) continue;
    result.points.push_back(point);
    result.pixels.push_back(*place);
  }
  return result;
}

/// Velocities from the states before and after.
void InitialTrajectory::take_velocities() {
  for (std::size_t i = 0; i < states_.size(); ++i) {
    const ControlState& a = states_[i > 0 ? i - 1 : i];
    const ControlState& b = states_[i + 1 < states_.size() ? i + 1 : i];
    states_[i].velocity = se3::log(a.T.inverse() * b.T) / (b.t - a.t);
  }
}

}  // namespace evbench::gp_map
