#pragma once

#include "backends/gp_map/map.hpp"

namespace evbench::gp_map {

// What is learnt from motion that is known from both sides: prior, noise and the weights of tracks.

/// While running: smoothed estimates of noise and prior in a span; `surplus`: see learn_prior().
void learn_smoothed(Map& map, TrackTable& tracks, const Options& options, const TimeSpan& span,
                    std::span<const double> surplus = {});

/// The final estimate, with all data known: estimates prior, noise and the weights of the tracks from the trajectory,
/// and the trajectory with them. Only with full history.
OptimiseSummary estimate_everything(Map& map, TrackTable& tracks, const Options& options);

/// The same for a lag: prior and noise of what has not been marginalised.
void estimate_remaining(Map& map, TrackTable& tracks, const Options& options);

}  // namespace evbench::gp_map
