#pragma once

#include "core/data/track.hpp"
#include "core/smoother/smoother.hpp"

namespace evbench::gp_map {

using namespace smoother;

inline Observation to_observation(const UndistortedObservation& z, double sigma_scale) {
  return {z.t, z.pixel, z.noise.scaled(sigma_scale).whitening()};
}

}  // namespace evbench::gp_map
