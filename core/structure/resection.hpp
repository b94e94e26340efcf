#pragma once

#include <optional>
#include <span>

#include "core/structure/point_image.hpp"

namespace evbench {

struct Resection {
  SE3 T;                   ///< T_world_camera
  double median_px = 0.0;  ///< median distance of the points' images from where they were observed
};

/// The pose of a camera that sees points[i] at pixels[i], from a guess: Gauss-Newton on the reprojection error with a
/// bounded loss of width [px], or as wide as three median errors while these are larger. None for fewer than four
/// points, and where half of them get behind the camera or they don't determine the pose.
std::optional<Resection> resect(const SE3& guess, std::span<const InversePoint> points, std::span<const Vector2> pixels,
                                const PinholeCamera& camera, double width);

}  // namespace evbench
