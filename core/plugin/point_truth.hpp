#pragma once

#include <optional>

#include "core/geometry/types.hpp"

namespace evbench {

/// Ground truth of feature tracks: where points of the scene are seen.
class PointTruth {
 public:
  virtual ~PointTruth() = default;

  /// The point of the scene, world frame, that is seen at a raw pixel at time t [s]; none where nothing is.
  virtual std::optional<Vector3> point(const Vector2& pixel, double t) const = 0;

  /// The raw pixel at which a point of the scene is seen at time t [s]; none outside the image or if it is occluded.
  virtual std::optional<Vector2> pixel(const Vector3& point, double t) const = 0;
};

}  // namespace evbench
