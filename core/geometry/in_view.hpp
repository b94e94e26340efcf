#pragma once

#include <cmath>

#include "core/geometry/camera.hpp"

namespace evbench {

/// A reach for in_view() that covers the larger field of view of distorted lenses.
inline constexpr double kLensReach = 1.5;

/// Is the pixel, along each axis, at most `reach` times as far from the principal point as the image border?
inline bool in_view(const PinholeCamera& camera, const Vector2& pixel, double reach) {
  return std::abs(pixel.x() - camera.cx) <= reach * camera.cx && std::abs(pixel.y() - camera.cy) <= reach * camera.cy;
}

}  // namespace evbench
