#include "landmarks.hpp"

#include <algorithm>

#include "cost_functions.hpp"

namespace spline_map {

double mean_error(const MappedTrack& landmark, const Spline& spline, const evbench::PinholeCamera& camera) {
  if (landmark.observations.empty()) return 0.0;
  double sum = 0.0;
  Spline::Place last;
  SplineSegment segment = spline.segment(0);
  for (const evbench::UndistortedObservation& z : landmark.observations) {
    const Spline::Place at = spline.place(z.t);
    if (at.segment != last.segment) segment = spline.segment(at.segment);
    last = at;
    sum += reprojection_error(segment.pose(at.u), landmark.position, z.pixel, camera).norm();
  }
  return sum / static_cast<double>(landmark.observations.size());
}

evbench::Triangulation triangulate_track(std::span<const evbench::UndistortedObservation> observations,
                                         const Spline& spline, const evbench::PinholeCamera& camera,
                                         const evbench::TriangulationOptions& options) {
  constexpr std::size_t kMost = 24;
  const auto first = std::ranges::lower_bound(observations, spline.start(), {}, &evbench::UndistortedObservation::t);
  const std::span<const evbench::UndistortedObservation> usable(first, observations.end());
  const std::size_t views = std::min(kMost, usable.size());
  std::vector<SE3> poses;
  std::vector<Vector2> pixels;
  for (std::size_t i = 0; i < views; ++i) {
    const std::size_t chosen = views < 2 ? 0 : i * (usable.size() - 1) / (views - 1);
    poses.push_back(spline.pose(usable[chosen].t));
    pixels.push_back(usable[chosen].pixel);
  }
  return evbench::triangulate(poses, pixels, camera, options);
}

}  // namespace spline_map
