#include "core/plugin/undistort.hpp"

namespace evbench {

std::optional<UndistortedObservation> undistort(const TrackObservation& z, const Camera& camera) {
  // Not even rounding may change an observation of a camera without distortion.
  if (camera.distortion == DistortionModel::none) return UndistortedObservation{z.track, z.t, z.pixel, z.noise};
  const std::optional<Vector2> pixel = camera.undistort(z.pixel);
  if (!pixel) return std::nullopt;
  return UndistortedObservation{z.track, z.t, *pixel, z.noise.mapped(camera.distortion_jacobian(*pixel).inverse())};
}

UndistortedBatch undistort(const TrackBatch& batch, const Camera& camera) {
  UndistortedBatch result{{}, batch.ended, batch.until, batch.seen};
  result.observations.reserve(batch.observations.size());
  for (const TrackObservation& z : batch.observations) {
    if (const auto observation = undistort(z, camera)) result.observations.push_back(*observation);
  }
  return result;
}

}  // namespace evbench
