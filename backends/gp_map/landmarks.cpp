#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "backends/gp_map/gp_map.hpp"
#include "backends/gp_map/problem_graph.hpp"
#include "core/support/median.hpp"

// The life of landmarks: which tracks become landmarks, where these are, and when they are removed.
namespace evbench::gp_map {
namespace {

constexpr double kReacquired = 10.0;  ///< [s] within which most lost landmarks are re-acquired
constexpr double kWellSeen = 1.5;     ///< error of a landmark's first observations, in multiples of the noise

}  // namespace

/// Removes landmarks of the newest interval whose error at the last optimum was too large compared with all tracks.
/// Newer observations do not count: their distance from an extrapolated pose depends on the motion first. Whether a
/// re-acquired track shows its landmark is check_reappeared()'s to say.
void GpMap::remove_outliers() {
  std::vector<int> outliers;
  for (const auto& group : graph().intervals.back().groups()) {
    if (!is_reappearing(group.landmark) && is_outlier(group.landmark)) outliers.push_back(group.landmark);
  }
  // If these are most tracks, the motion is wrong.
  if (2 * outliers.size() > graph().intervals.back().groups().size()) return;
  for (const int landmark : outliers) become_outlier(landmark);
}

/// Is it being checked whether a re-acquired track shows it?
bool GpMap::is_reappearing(int landmark) const { return map_->reappeared.contains(map_->known[index(landmark)].track); }

bool GpMap::is_outlier(int landmark) {
  const FactorGraph::Landmark& l = graph().landmarks[index(landmark)];
  if (l.intervals.empty()) return false;
  const Observation& last = graph().intervals[index(l.intervals.back())].of(landmark).back();
  const double inverse_sigma = l.sigma_scale * last.whitening.inverse_sigma();  // as given
  const double far = options_.map.outlier_threshold * map_->noise.scale_of_means();
  return inverse_sigma * map_->engine.reprojection_mean(landmark) > far;
}

void GpMap::add_landmarks() {
  for (const TrackId id : waiting_.ids()) {
    const auto observations = waiting_.observations(id);
    const auto count = static_cast<int>(observations.size());
    Track& track = tracks_.at(id);
    const int enough = options_.map.min_observations;
    if (count < enough || count < track.tried_with + enough / 2) continue;
    track.tried_with = count;
    const auto [place, misfit] = locate(id);
    track.misfit = misfit;
    if (!place) continue;
    const int landmark = map_->engine.add_landmark(place->first, place->second);
    for (const TrackObservation& z : observations) {
      map_->engine.add_observation(landmark, to_observation(z, options_.sigma_scale));
    }
    if (std::isfinite(place->second.sigma)) map_->guessed.push_back(landmark);
    become_landmark(id, landmark);
  }
}

/// Drops the prior on a landmark's guessed depth once the landmark shows parallax: landmarks without parallax at first
/// are farther away than most.
void GpMap::drop_guessed_depths() {
  const double least = std::sin(options_.map.triangulation.min_parallax_deg / kDegrees);
  const std::vector<ControlState>& states = graph().states;
  std::erase_if(map_->guessed, [&](int j) {
    const FactorGraph::Landmark& landmark = graph().landmarks[index(j)];
    const std::vector<int>& seen = landmark.intervals;
    if (!landmark.alive || seen.empty() || states.back().t > states[index(seen.back())].t + kReacquired) return true;
    const auto ray = [&](int k) { return (landmark.position - states[index(k)].T.p).normalized().eval(); };
    if (ray(seen.front()).cross(ray(seen.back())).norm() < least) return false;
    map_->engine.drop_prior(j);
    return true;
  });
}

/// Locates a track's landmark by triangulation from its observations. Without parallax, it is put at the scene's depth:
/// it determines rotation, and where tracks are short, nothing else carries the scale on.
GpMap::Location GpMap::locate(TrackId id) const {
  constexpr std::size_t kViews = 16;  // evenly from all observations: enough for an initial value
  std::span<const TrackObservation> usable = waiting_.observations(id);  // none later than the newest state
  const auto marginalised = [&](const TrackObservation& z) {
    return graph().interval_of(z.t) <= map_->engine.first_state();
  };
  usable = usable.subspan(index(std::ranges::partition_point(usable, marginalised) - usable.begin()));
  if (usable.size() < 2) return {};
  std::vector<SE3> poses;
  std::vector<Vector2> pixels;
  const std::size_t views = std::min(kViews, usable.size());
  for (std::size_t i = 0; i < views; ++i) {
    const TrackObservation& z = usable[i * (usable.size() - 1) / (views - 1)];
    poses.push_back(*pose(z.t));
    pixels.push_back(z.pixel);
  }
  const Triangulation result = triangulate(poses, pixels, context_.camera, options_.map.triangulation);
  const double noise = options_.sigma_scale * usable.back().noise.sigma() * map_->noise.scale_of_means();
  if (result.ok() && result.rms_px <= kWellSeen * std::numbers::sqrt2 * noise) {
    return {.place = std::pair{result.point, LandmarkPrior{}}};
  }
  if (result.state != Triangulation::State::low_parallax) return {.misfit = true};
  if (usable.back().t - usable.front().t < options_.map.patience) return {};
  const double depth = median_depth();
  const Vector3 point = poses.back() * (depth * graph().camera.ray(pixels.back()));
  return {.place = std::pair{point, LandmarkPrior{point, options_.map.depth_sigma * depth}}};
}

/// Median depth of the landmarks seen last, from the newest pose.
double GpMap::median_depth() const {
  const SE3 T_camera_world = graph().states.back().T.inverse();
  std::vector<double> depths;
  for (std::size_t k = graph().intervals.size(); k-- > 0 && depths.size() < 10;) {
    for (const auto& group : graph().intervals[k].groups()) {
      const double z = (T_camera_world * graph().landmarks[index(group.landmark)].position).z();
      if (z > 0.0) depths.push_back(z);
    }
  }
  return depths.empty() ? 1.0 : median(depths);
}

void GpMap::become_landmark(TrackId id, int landmark) {
  Track& track = tracks_.at(id);
  track.role = Track::Role::landmark;
  track.landmark = landmark;
  map_->known.push_back({.track = id});
  ++map_->tracks;
  waiting_.forget(id);
}

void GpMap::become_outlier(int landmark) {
  anchor_scale_without(landmark);
  map_->engine.remove_landmark(landmark);
  if (end_track_of(landmark, Track::Role::outlier)) --map_->tracks;
}

/// Further observations of the track are not of this landmark. False if the track has become another landmark.
bool GpMap::end_track_of(int landmark, Track::Role role) {
  const auto track = tracks_.find(map_->known[index(landmark)].track);
  if (track == tracks_.end() || track->second.landmark != landmark) return false;
  track->second.role = role;
  map_->outliers.push_back(track->first);
  return true;
}

/// Before one of few landmarks of the scale anchor is removed, those in view are added to it, at the present scale.
void GpMap::anchor_scale_without(int leaving) {
  std::set<int> anchors(graph().anchor.landmarks.begin(), graph().anchor.landmarks.end());
  if (anchors.erase(leaving) == 0 || std::ssize(anchors) >= options_.health.min_landmarks) return;
  for (const auto& group : graph().intervals.back().groups()) {
    if (group.landmark != leaving) anchors.insert(group.landmark);
  }
  context_.log(fmt::format("{:.3f} s: most landmarks of the scale anchor were outliers; it has {} now",
                           graph().states.back().t, anchors.size()));
  map_->engine.anchor_scale(graph().anchor.origin, {anchors.begin(), anchors.end()});
}

}  // namespace evbench::gp_map
