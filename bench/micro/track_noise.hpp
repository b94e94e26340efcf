#pragma once

#include "backends/gp_map/factor_graph.hpp"

namespace evbench {

/// The errors of tracks, an axis of the image: white noise, and a drift of each track about its true place, an
/// Ornstein-Uhlenbeck process.
struct TrackNoise {
  double white = 1.0, drift = 0.0;  ///< standard deviations
  double time = 1.0;                ///< [s] of the drift's correlation, exp(−Δt/time)
};

/// Estimates it [sigmas that the observations state] from how much residuals of one landmark differ with the time that
/// lies between them, at the graph's estimate: half the mean square difference is white² + drift² (1 − exp(−Δt/time)),
/// in which an error of the landmark's own place has no part. Of medians, so that outliers count little. White and as
/// stated where tracks are too short to tell.
TrackNoise estimate_noise(const gp_map::FactorGraph& graph);

}  // namespace evbench
