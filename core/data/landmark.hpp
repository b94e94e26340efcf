#pragma once

#include "core/data/track.hpp"

namespace evbench {

/// A point of a map, with the track that observed it.
struct Landmark {
  TrackId track = 0;
  Vector3 position = Vector3::Zero();  ///< world frame, up to the back-end's scale
};

}  // namespace evbench
