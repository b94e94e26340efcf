#pragma once

#include <optional>

#include "core/geometry/camera.hpp"
#include "core/plugin/exchange.hpp"

namespace evbench {

/// The observation on its undistorted pixel, with the noise there; none where the lens model has no inverse.
std::optional<UndistortedObservation> undistort(const TrackObservation& z, const Camera& camera);

/// The batch without the observations that have no undistorted pixel.
UndistortedBatch undistort(const TrackBatch& batch, const Camera& camera);

}  // namespace evbench
