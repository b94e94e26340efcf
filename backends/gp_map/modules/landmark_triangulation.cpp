#include "backends/gp_map/modules/landmark_triangulation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/smoother/problem_graph.hpp"

namespace evbench::gp_map {
namespace {

constexpr double kReacquired = 10.0;  ///< [s] within which most lost landmarks are re-acquired
constexpr double kWellSeen = 1.5;     ///< error of a landmark's first observations, in multiples of the noise
constexpr std::size_t kViews = 16;    ///< evenly from all observations: enough for an initial value

}  // namespace

void MapOptions::declare(OptionSet& set) {
  set.group("triangulation", triangulation, "when a track becomes a landmark");
  set.add("min_observations", min_observations, "observations that a track needs to become a landmark").range(2);
  set.add("patience", patience,
          "a track that shows no parallax for this long becomes a landmark at the scene's median depth: it determines "
          "rotation, and where tracks are short, the scale as well; the guess counts until there is parallax [s]")
      .range(0.0);
  set.add("depth_sigma", depth_sigma, "standard deviation of that guess, as a share of the depth").above(0.0);
  set.add("tentative", tentative,
          "until it has seen so much motion, the whole map may be replaced, and no track is rejected or truncated by "
          "its "
          "averaged errors of the last second [s]")
      .range(0.0);
}

void LandmarkTriangulation::add(Estimate& estimate, TrackTable& tracks) {
  for (const TrackId id : tracks.waiting().ids()) {
    const auto observations = tracks.waiting().observations(id);
    const auto count = static_cast<int>(observations.size());
    TrackTable::Track& track = tracks.at(id);
    const int enough = options_.min_observations;
    if (count < enough || count < track.tried_with + enough / 2) continue;
    track.tried_with = count;
    const auto [place, misfit] = locate(estimate, observations);
    track.misfit = misfit;
    if (misfit) estimate.count(Count::misfits);
    if (!place) continue;
    const int landmark = estimate.add_landmark(place->first, place->second);
    for (const UndistortedObservation& z : observations) {
      estimate.smoother.add_observation(landmark, to_observation(z, sigma_scale_));
    }
    estimate.count(Count::landmarks);
    if (std::isfinite(place->second.sigma)) {
      guessed_.push_back(landmark);
      estimate.count(Count::landmarks_without_depth);
    }
    tracks.become_landmark(id, landmark);
  }
}

void LandmarkTriangulation::drop_guesses(Estimate& estimate) {
  const FactorGraph& graph = estimate.graph();
  const double least = std::sin(options_.triangulation.min_parallax_deg / kDegrees);
  std::erase_if(guessed_, [&](int j) {
    const FactorGraph::Landmark& landmark = graph.landmarks[index(j)];
    const std::vector<int>& seen = landmark.intervals;
    if (!landmark.alive || seen.empty() || estimate.now() > graph.states[index(seen.back())].t + kReacquired)
      return true;
    const auto ray = [&](int k) { return (landmark.position - graph.states[index(k)].T.p).normalized().eval(); };
    if (ray(seen.front()).cross(ray(seen.back())).norm() < least) return false;
    estimate.smoother.remove_prior(j);
    return true;
  });
}

LandmarkTriangulation::Location LandmarkTriangulation::locate(
    const Estimate& estimate, std::span<const UndistortedObservation> observations) const {
  const FactorGraph& graph = estimate.graph();
  const auto marginalised = [&](const UndistortedObservation& z) {
    return graph.interval_of(z.t) <= estimate.smoother.first_state();
  };
  const auto usable =  // none is later than the newest state
      observations.subspan(index(std::ranges::partition_point(observations, marginalised) - observations.begin()));
  if (usable.size() < 2) return {};
  std::vector<SE3> poses;
  std::vector<Vector2> pixels;
  const std::size_t views = std::min(kViews, usable.size());
  for (std::size_t i = 0; i < views; ++i) {
    const UndistortedObservation& z = usable[i * (usable.size() - 1) / (views - 1)];
    poses.push_back(*estimate.pose(z.t));
    pixels.push_back(z.pixel);
  }
  const Triangulation result = triangulate(poses, pixels, graph.camera, options_.triangulation);
  const double noise = sigma_scale_ * usable.back().noise.sigma() * estimate.noise.scale_of_means();
  if (result.ok() && result.rms_px <= kWellSeen * std::numbers::sqrt2 * noise) {
    return {.place = std::pair{result.point, LandmarkPrior{}}};
  }
  if (result.state != Triangulation::State::low_parallax) return {.misfit = true};
  if (usable.back().t - usable.front().t < options_.patience) return {};
  const double depth = estimate.median_depth();
  const Vector3 point = poses.back() * (depth * graph.camera.ray(pixels.back()));
  return {.place = std::pair{point, LandmarkPrior{point, options_.depth_sigma * depth}}};
}

}  // namespace evbench::gp_map
