#pragma once

#include "core/smoother/factor_graph.hpp"

namespace evbench {

/// The errors of tracks, an axis of the image: white noise, and a drift of each track about its true place, an
/// Ornstein-Uhlenbeck process.
struct TrackNoise {
  double white = 1.0, drift = 0.0;  ///< standard deviations
  double time = 1.0;                ///< [s] of the drift's correlation, exp(−Δt/time)
};

/// Estimates the track noise, in units of the observations' stated sigmas, from the differences of residuals of one
/// landmark over the time between them, at the graph's estimate. Half the mean square difference is
/// white² + drift² (1 − exp(−Δt/time)), which is independent of the landmark's own position error. Medians are used, so
/// that outliers count little. Where tracks are too short, the noise is white and as stated.
TrackNoise estimate_noise(const smoother::FactorGraph& graph);

}  // namespace evbench
