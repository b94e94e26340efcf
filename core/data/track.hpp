#pragma once

#include <cstdint>

#include "core/geometry/pixel_noise.hpp"

namespace evbench {

using TrackId = std::int64_t;

struct RawPixels {};          ///< as the sensor reports them: of events, front-ends, track files
struct UndistortedPixels {};  ///< of the ideal pinhole camera, without the lens's distortion: of back-ends

/// One observation of a tracked feature at its own time. A track is the set of observations with one id; it starts, is
/// updated at irregular times, and ends.
template <class Pixels>
struct ObservationOf {
  TrackId track = 0;
  double t = 0.0;                   ///< [s], sequence time
  Vector2 pixel = Vector2::Zero();  ///< [px]
  PixelNoise noise = 1.0;           ///< of `pixel`
};
using TrackObservation = ObservationOf<RawPixels>;                ///< the output of every front-end
using UndistortedObservation = ObservationOf<UndistortedPixels>;  ///< the input of every back-end

/// End of a track: no observation of it follows, unless a front-end re-associates its landmark with the help of the
/// back-end's expected features (exchange.hpp). Then the track continues.
struct TrackEnd {
  TrackId track = 0;
  double t = 0.0;  ///< [s], sequence time; not before the track's last observation
};

}  // namespace evbench
