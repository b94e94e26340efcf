#pragma once

#include <optional>
#include <span>

#include "core/structure/point_image.hpp"

namespace evbench {

struct Resection {
  SE3 T;                   ///< T_world_camera
  double median_px = 0.0;  ///< median reprojection error
};

/// The pose of a camera that observes points[i] at pixels[i], from an initial guess: Gauss-Newton on the reprojection
/// error with a bounded loss. Its width is `width` [px], or three median errors while these are larger. None for fewer
/// than four points, if half of them are behind the camera, or if they don't determine the pose.
std::optional<Resection> resect(const SE3& guess, std::span<const InversePoint> points, std::span<const Vector2> pixels,
                                const PinholeCamera& camera, double width);

}  // namespace evbench
