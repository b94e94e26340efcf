#pragma once

#include <optional>
#include <span>

#include "core/data/landmark.hpp"
#include "core/geometry/camera.hpp"
#include "core/geometry/similarity.hpp"

namespace evbench {

/// Alignment of one map with another.
struct MapAlignment {
  Similarity transform;  ///< from the other map's world to this one's
  int landmarks = 0;     ///< common landmarks that agree
};

/// Aligns `other` with `map` by their common landmarks, associated by their tracks. The landmarks are compared in the
/// images of cameras that saw `map` (`views`: poses in its world), so that uncertain distances matter little. Robust
/// against wrong landmarks and tracks that are on different points in both maps, as long as a third agrees. None if
/// fewer than eight agree or the scale is not known to 3 %.
std::optional<MapAlignment> align_maps(std::span<const Landmark> map, std::span<const SE3> views,
                                       std::span<const Landmark> other, const PinholeCamera& camera);

}  // namespace evbench
