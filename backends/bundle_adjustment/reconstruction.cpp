#include "backends/bundle_adjustment/reconstruction.hpp"

#include <algorithm>

#include "backends/bundle_adjustment/reprojection.hpp"
#include "core/support/index.hpp"
#include "core/support/median.hpp"

namespace evbench::bundle_adjustment {

int Reconstruction::add(const Batch& batch) {
  const int index = static_cast<int>(views.size());
  views.push_back({batch.t, SE3{}, View::State::unknown, batch.keypoints});
  for (const Keypoint& keypoint : batch.keypoints) {
    tracks[keypoint.track].sightings.push_back({index, keypoint.pixel, keypoint.noise});
  }
  return index;
}

void Reconstruction::remove(TrackId track) {
  const auto found = tracks.find(track);
  if (found == tracks.end()) return;
  for (const TrackSighting& sighting : found->second.sightings) {
    std::erase_if(views[index(sighting.view)].keypoints,
                  [&](const Keypoint& keypoint) { return keypoint.track == track; });
  }
  tracks.erase(found);
}

void Reconstruction::cut_tracks(int view) {
  for (auto& [id, track] : tracks) {
    if (track.sightings.back().view < view) continue;
    std::erase_if(track.sightings, [&](const TrackSighting& z) { return z.view < view; });
    track.position.reset();
  }
}

std::vector<Keypoint> Reconstruction::landmarks_in(int view) const {
  std::vector<Keypoint> result;
  for (const Keypoint& keypoint : views[index(view)].keypoints) {
    if (tracks.at(keypoint.track).position) result.push_back(keypoint);
  }
  return result;
}

Triangulation Reconstruction::triangulate_track(const Track& track, const PinholeCamera& camera,
                                                const TriangulationOptions& options) const {
  std::vector<SE3> poses;
  std::vector<Vector2> pixels;
  for (const TrackSighting& sighting : track.sightings) {
    const View& view = views[index(sighting.view)];
    if (!view.estimated()) continue;
    poses.push_back(view.T);
    pixels.push_back(sighting.pixel);
  }
  return triangulate(poses, pixels, camera, options);
}

void Reconstruction::triangulate_new(const PinholeCamera& camera, const TriangulationOptions& options,
                                     const Maturity& needed) {
  for (const Keypoint& keypoint : views.back().keypoints) {
    Track& track = tracks.at(keypoint.track);
    if (track.position || static_cast<int>(track.sightings.size()) < needed.views) continue;
    if (views.back().t - views[index(track.sightings.front().view)].t < needed.time) continue;
    const Triangulation result = triangulate_track(track, camera, options);
    if (result.ok()) track.position = result.point;
  }
}

double Reconstruction::mean_error(const Track& track, const PinholeCamera& camera) const {
  double sum = 0.0, count = 0.0;
  for (const TrackSighting& sighting : track.sightings) {
    const View& view = views[index(sighting.view)];
    if (!view.estimated()) continue;
    sum += reprojection_error(view.T, *track.position, sighting.pixel, camera).norm();
    count += 1.0;
  }
  return count > 0.0 ? sum / count : 0.0;
}

std::optional<double> Reconstruction::noise_factor(const PinholeCamera& camera, int first) const {
  constexpr double kMedianOfTwo = 1.17741;  // median length of two independent standard normal numbers
  std::vector<double> errors;
  for (const auto& [id, track] : tracks) {
    if (!track.position) continue;
    for (const TrackSighting& z : track.sightings) {
      const View& view = views[index(z.view)];
      if (z.view < first || !view.estimated()) continue;
      const Vector2 error = reprojection_error(view.T, *track.position, z.pixel, camera);
      errors.push_back((z.noise.whitening() * error).norm());
    }
  }
  if (errors.empty()) return std::nullopt;
  return median(std::move(errors)) / kMedianOfTwo;
}

std::vector<TrackId> Reconstruction::outliers(const PinholeCamera& camera, double limit_px, int first) {
  std::vector<TrackId> result;
  TriangulationOptions options;
  options.max_rms_px = 2.0 * limit_px;
  options.min_parallax_deg = 0.1;
  for (auto& [id, track] : tracks) {
    if (!track.position || track.sightings.back().view < first) continue;
    if (mean_error(track, camera) <= limit_px) continue;
    const Triangulation again = triangulate_track(track, camera, options);
    if (again.ok()) track.position = again.point;
    if (!again.ok() || mean_error(track, camera) > limit_px) result.push_back(id);
  }
  return result;
}

}  // namespace evbench::bundle_adjustment
