#pragma once

#include <span>

#include "core/data/track.hpp"
#include "core/simulation/random.hpp"

namespace evbench {

/// Adds a slow tracking error: each track drifts about its true position, by an Ornstein-Uhlenbeck process in each axis
/// of the image with this standard deviation [px] and a correlation of exp(−Δt/time). It is added to the pixels and to
/// the sigmas that the observations state. `observations` of each track are in time order.
void add_wander(std::span<TrackObservation> observations, double deviation, double time, Random random);

}  // namespace evbench
