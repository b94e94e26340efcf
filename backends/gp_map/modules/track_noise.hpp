#pragma once

#include "backends/gp_map/estimate.hpp"
#include "backends/gp_map/smoother.hpp"
#include "core/plugin/options.hpp"
#include "core/smoother/time_span.hpp"

namespace evbench::gp_map {

struct TrackNoiseOptions {
  bool enabled = true;
  double change = 1.5;

  void declare(OptionSet& set);
};

/// Gives each track its own noise, within the bounds of its leverage: tracks differ by degrees, not only as outliers
/// and inliers.
class TrackNoise {
 public:
  /// `memory`: while running, the noise of tracks up to this age is estimated [s].
  TrackNoise(const TrackNoiseOptions& options, double memory) : options_(options), memory_(memory) {}

  /// For each track seen since the beginning of this span. All observations count, the newest too, because a drifting
  /// track must soon count less. While running only recent tracks get new factors, which bounds how far back stages are
  /// redone.
  void estimate_tracks(Estimate& estimate, const TimeSpan& span) const;

 private:
  TrackNoiseOptions options_;
  double memory_;
};

}  // namespace evbench::gp_map
