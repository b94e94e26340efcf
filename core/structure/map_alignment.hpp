#pragma once

#include <optional>
#include <span>

#include "core/data/landmark.hpp"
#include "core/geometry/camera.hpp"
#include "core/geometry/similarity.hpp"

namespace evbench {

/// Where one map lies in another.
struct MapAlignment {
  Similarity transform;  ///< carries the other map's world to this one's
  int landmarks = 0;     ///< of both maps, that agree
};

/// Aligns `other` with `map` by the landmarks that both have, told by their tracks. They are compared in the images of
/// cameras that saw `map`, whose poses in its world are `views`: there both maps have to be right, whatever distances
/// are uncertain. Wrong landmarks, and tracks that are not on the same point in both, are borne, as long as a third
/// agrees. None where fewer than eight agree, or the scale is not known to 3 %.
std::optional<MapAlignment> align_maps(std::span<const Landmark> map, std::span<const SE3> views,
                                       std::span<const Landmark> other, const PinholeCamera& camera);

}  // namespace evbench
