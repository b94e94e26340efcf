#pragma once

#include <cmath>

#include "core/geometry/camera.hpp"

namespace evbench {

/// A reach within which lenses may see, which see farther than pinholes.
inline constexpr double kLensReach = 1.5;

/// Is the pixel, along each axis, no farther from the principal point than `reach` times the image's border is?
inline bool in_view(const PinholeCamera& camera, const Vector2& pixel, double reach) {
  return std::abs(pixel.x() - camera.cx) <= reach * camera.cx && std::abs(pixel.y() - camera.cy) <= reach * camera.cy;
}

}  // namespace evbench
