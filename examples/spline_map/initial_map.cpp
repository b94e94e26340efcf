#include "initial_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <evbench/plugin.hpp>

namespace spline_map {
namespace {

using evbench::InitialGuess;
using evbench::TrackBuffer;

/// With this multiple of the needed parallax, the initial map with the lower cost is accepted even if the costs are
/// close.
constexpr double kDecisiveParallax = 2.0;
constexpr int kRefineIterations = 30;

/// The motion of the guess at constant velocity, before, between and after its two views.
Spline straight_motion(const InitialGuess& guess, double start, double spacing) {
  const Vector6 velocity = evbench::se3::log(guess.T1) / (guess.t1 - guess.t0);
  Spline spline(start, spacing, SE3{});
  spline.extend_to(guess.t1);
  for (std::size_t k = 0; k < spline.knots().size(); ++k) {
    spline.knots()[k] = Knot(evbench::se3::exp((spline.knot_time(k) - guess.t0) * velocity));
  }
  return spline;
}

/// Observations from a time on, subsampled evenly if there are many: enough for the initial map.
std::vector<evbench::UndistortedObservation> sample(std::span<const evbench::UndistortedObservation> all, double from) {
  constexpr std::size_t kMost = 100;
  const auto first = std::ranges::lower_bound(all, from, {}, &evbench::UndistortedObservation::t);
  const std::span<const evbench::UndistortedObservation> usable(first, all.end());
  const std::size_t count = std::min(kMost, usable.size());
  std::vector<evbench::UndistortedObservation> result;
  for (std::size_t i = 0; i < count; ++i) result.push_back(usable[i * usable.size() / count]);
  return result;
}

double parallax_deg(const InitialMap& map, double t1) {
  const Vector3 first = map.spline.pose(map.spline.start()).p, last = map.spline.pose(t1).p;
  std::vector<double> angles;
  for (const auto& [id, landmark] : map.landmarks) {
    const Vector3 a = landmark.position - first, b = landmark.position - last;
    angles.push_back(std::atan2(a.cross(b).norm(), a.dot(b)) * evbench::kDegrees);
  }
  return evbench::median(std::move(angles));
}

}  // namespace

std::optional<InitialMap> InitialMapFinder::attempt(const TrackBuffer& tracks, double t) {
  const evbench::Initialiser::Attempt attempt = initialiser_.attempt(tracks, t);
  reason_ = attempt.reason;
  std::vector<InitialMap> refined;
  for (const InitialGuess& guess : attempt.candidates) {
    std::optional<InitialMap> map = refine(tracks, guess);
    if (!map) continue;
    const auto same = [&](const InitialMap& other) {  // guesses that converge to the same solution are not ambiguous
      return evbench::same_motion(other.spline.pose(t), map->spline.pose(t));
    };
    if (std::ranges::none_of(refined, same)) refined.push_back(std::move(*map));
  }
  if (refined.empty()) {
    if (!attempt.candidates.empty()) reason_ = "the initial map does not explain the observations";
    return std::nullopt;
  }
  std::ranges::sort(refined, {}, &InitialMap::cost);
  // The parallax of two views may be noise; the refined map uses every observation.
  const double needed = options_.initialiser.two_view.min_parallax_deg;
  if (refined[0].parallax_deg < needed) {
    reason_ = fmt::format("median parallax {:.2f} deg, {:.2f} needed", refined[0].parallax_deg, needed);
    return std::nullopt;
  }
  if (refined.size() > 1 && refined[1].cost < options_.ambiguity_ratio * refined[0].cost &&
      refined[0].parallax_deg < kDecisiveParallax * needed) {
    reason_ = "two initial maps explain the observations equally well";
    return std::nullopt;
  }
  return std::move(refined[0]);
}

/// None if the refined guess doesn't fit the data.
std::optional<InitialMap> InitialMapFinder::refine(const TrackBuffer& tracks, const InitialGuess& guess) const {
  InitialMap map;
  map.spline = straight_motion(guess, start_time(tracks, guess), options_.knot_spacing);
  const SE3 world = map.spline.pose(map.spline.start()).inverse();
  for (Knot& knot : map.spline.knots()) knot = Knot(world * SE3{knot.rotation(), knot.position()});
  for (const evbench::Landmark& landmark : guess.landmarks) {
    MappedTrack& mapped = map.landmarks[landmark.track];
    mapped.position = world * landmark.position;
    mapped.observations = sample(tracks.observations(landmark.track), map.spline.start());
  }
  const double baseline = (map.spline.pose(guess.t1).p - map.spline.pose(guess.t0).p).norm();
  map.gauge = {map.spline.pose(map.spline.start()), guess.t0, guess.t1, baseline};
  const SolveReport report =
      solve(map.spline, map.landmarks, options_.densities(map.spline, map.spline.start()), camera_, map.gauge,
            {0, map.spline.start()}, options_.solver(kRefineIterations, 1e-6));
  if (!report.usable || report.observations == 0) return std::nullopt;
  std::vector<double> errors;
  for (const auto& [id, landmark] : map.landmarks) errors.push_back(mean_error(landmark, map.spline, camera_));
  if (!(evbench::median(std::move(errors)) <= options_.max_initial_error)) return std::nullopt;
  map.cost = report.cost / report.observations;
  map.parallax_deg = parallax_deg(map, guess.t1);
  return map;
}

/// Start time of the spline: the time from which enough landmarks of the guess are observed, limited to as long before
/// its first view as its second view is after it.
double InitialMapFinder::start_time(const TrackBuffer& tracks, const InitialGuess& guess) const {
  std::vector<double> seen_from;
  for (const evbench::Landmark& landmark : guess.landmarks) {
    const auto observations = tracks.observations(landmark.track);
    if (!observations.empty()) seen_from.push_back(observations.front().t);
  }
  const auto enough = static_cast<std::size_t>(options_.min_landmarks);
  if (seen_from.size() < enough) return guess.t0;
  std::ranges::sort(seen_from);
  return std::clamp(seen_from[enough - 1], 2.0 * guess.t0 - guess.t1, guess.t0);
}

}  // namespace spline_map
