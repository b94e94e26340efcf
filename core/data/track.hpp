#pragma once

#include <cstdint>

#include "core/geometry/types.hpp"

namespace evbench {

using TrackId = std::int64_t;

/// One observation of a tracked feature at its own time: what every front-end emits and every back-end takes, in time
/// order. A track is the set of observations with one id; it starts, is updated at irregular times, and ends.
struct TrackObservation {
  TrackId track = 0;
  double t = 0.0;                   ///< [s], sequence time
  Vector2 pixel = Vector2::Zero();  ///< [px]; raw from a front-end, undistorted when a back-end gets it
  double sigma = 1.0;               ///< isotropic standard deviation [px]
};

/// A track has ended: no observation of it follows, unless its landmark is found again by a front-end that looks for
/// what the back-end expects (exchange.hpp). Then it goes on.
struct TrackEnd {
  TrackId track = 0;
  double t = 0.0;  ///< [s], sequence time; not before the track's last observation
};

}  // namespace evbench
