#include "backends/gp_map/modules/reassociation.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/smoother/factors.hpp"

namespace evbench::gp_map {
namespace {

constexpr double kGone = 0.05;       ///< [s] shortest gap before a re-acquisition
constexpr std::ptrdiff_t kMany = 5;  ///< re-acquired tracks

/// Distance of the landmark's image at the present estimate from its first observation [sigmas of a track's means];
/// infinite behind the camera.
double distance(const Estimate& estimate, const Reappearance& seen) {
  const FactorGraph& graph = estimate.graph();
  const auto k = index(graph.interval_of(seen.t));
  const GpInterval interval = graph.interval(static_cast<int>(k));
  const Vector3& position = graph.landmarks[index(seen.landmark)].position;
  return seen.inverse_sigma * reprojection_error(interval, position, {seen.t, seen.pixel, 1.0}, graph.camera) /
         estimate.noise.scale_of_means();
}

}  // namespace

void ReassociationOptions::declare(OptionSet& set) {
  set.add("enabled", enabled, "re-acquired tracks that stay far off their landmarks' places are rejected");
  set.add("returns", returns,
          "maximum number of landmarks that are out of view at one time and are re-acquired later: further re-acquired "
          "tracks become new landmarks with a prior at the old place")
      .range(0);
  set.add("threshold", threshold, "that is far [sigmas of a track's mean error]").above(0.0);
  set.add("time", time, "after which a re-acquired track is judged [s]").range(0.0);
}

void Reassociation::observe(Estimate& estimate, TrackTable& tracks, const UndistortedObservation& z) {
  const TrackTable::Track& track = tracks.at(z.track);
  const std::vector<int>& intervals = estimate.graph().landmarks[index(track.landmark)].intervals;
  const int last = intervals.empty() ? 0 : intervals.back();
  const bool reappears = track.ended && last > 0 && z.t - estimate.graph().states[index(last)].t > kGone;
  if (!continues(estimate, track)) {
    if (split(estimate, tracks, z.track)) estimate.count(Count::reacquired_as_new);
  } else if (reappears && !tracks.reappeared().contains(z.track)) {
    tracks.reappear(z.track, {track.landmark, z.t, z.pixel, 1.0 / (sigma_scale_ * z.noise.sigma())});
    estimate.count(Count::reacquired);
  }
}

bool Reassociation::continues(const Estimate& estimate, const TrackTable::Track& track) {
  if (estimate.smoother.is_marginalised(track.landmark)) return false;
  const auto& seen = estimate.graph().landmarks[index(track.landmark)].intervals;
  const int newest = static_cast<int>(estimate.graph().states.size()) - 1;
  return !track.ended || seen.empty() || seen.back() >= newest || returns_.spend(seen.back(), newest + 1);
}

/// The covariance of the old landmark counts as independent of the motion since. False, and the track waits, if it is
/// not known.
bool Reassociation::split(Estimate& estimate, TrackTable& tracks, TrackId id) const {
  const int old = tracks.at(id).landmark;
  const std::optional<Matrix3> known = estimate.kept_covariance(old);
  if (!known) {
    tracks.wait_again(id);
    return false;
  }
  const Vector3 position = estimate.graph().landmarks[index(old)].position;
  const double sigma = std::sqrt(known->selfadjointView<Eigen::Lower>().eigenvalues().maxCoeff());
  tracks.become_another(id, estimate.add_landmark(position, {position, sigma}));
  return true;
}

void Reassociation::check(Estimate& estimate, TrackTable& tracks) const {
  auto& reappeared = tracks.reappeared();
  std::erase_if(reappeared, [&](const auto& entry) {
    const TrackTable::Track* const track = tracks.find(entry.first);
    return track == nullptr || track->role != TrackTable::Role::landmark || track->landmark != entry.second.landmark;
  });
  const auto is_far = [&](const auto& entry) { return distance(estimate, entry.second) > options_.threshold; };
  const auto far = std::ranges::count_if(reappeared, is_far);
  const bool checked = options_.enabled && !estimate.is_tentative() &&
                       (std::ssize(reappeared) < kMany || 2 * far <= std::ssize(reappeared));
  std::erase_if(reappeared, [&](const auto& entry) {
    const auto& [id, seen] = entry;
    if (estimate.now() - seen.t < options_.time) return false;
    if (checked && is_far(entry)) {
      estimate.smoother.remove_observations(seen.landmark, seen.t);
      tracks.mismatch(id);
      estimate.count(Count::reassociations_rejected);
    }
    return true;
  });
}

}  // namespace evbench::gp_map
