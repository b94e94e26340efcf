#pragma once

#include <vector>

#include "core/data/track.hpp"
#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"
#include "core/simulation/random.hpp"

namespace evbench::testing {

/// Gaussian noise of a pixel position [px].
inline Vector2 noise(double sigma, Random& random) {
  const double x = random.normal();
  return sigma * Vector2(x, random.normal());
}

/// The DAVIS240C of the Event-Camera Dataset, undistorted.
inline PinholeCamera davis() { return {199.0, 199.0, 120.0, 90.0}; }

inline bool in_davis_image(const Vector2& pixel) {
  return pixel.x() >= 0.0 && pixel.y() >= 0.0 && pixel.x() <= 239.0 && pixel.y() <= 179.0;
}

enum class PointScene { volume, plane };

/// Points about 2 m in front of a camera at the origin with z forward: in a volume, or on a slightly tilted plane.
inline std::vector<Vector3> scene_points(PointScene scene, int count, Random& random, double width = 2.6) {
  std::vector<Vector3> points;
  for (int i = 0; i < count; ++i) {
    const double x = random.uniform(-0.5 * width, 0.5 * width), y = random.uniform(-0.4 * width, 0.4 * width);
    const double z = scene == PointScene::plane ? 2.0 + 0.2 * x - 0.1 * y : random.uniform(1.4, 3.2);
    points.emplace_back(x, y, z);
  }
  return points;
}

}  // namespace evbench::testing
