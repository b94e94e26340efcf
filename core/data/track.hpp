#pragma once

#include <cstdint>

#include "core/geometry/pixel_noise.hpp"

namespace evbench {

using TrackId = std::int64_t;

/// One observation of a tracked feature at its own time: the output of every front-end and the input of every back-end,
/// in time order. A track is the set of observations with one id; it starts, is updated at irregular times, and ends.
struct TrackObservation {
  TrackId track = 0;
  double t = 0.0;                   ///< [s], sequence time
  Vector2 pixel = Vector2::Zero();  ///< [px]; raw from a front-end, undistorted for a back-end
  PixelNoise noise = 1.0;           ///< of `pixel`
};

/// End of a track: no observation of it follows, unless a front-end re-associates its landmark with the help of the
/// back-end's expected features (exchange.hpp). Then the track continues.
struct TrackEnd {
  TrackId track = 0;
  double t = 0.0;  ///< [s], sequence time; not before the track's last observation
};

}  // namespace evbench
