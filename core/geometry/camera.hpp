#pragma once

#include <optional>
#include <string>

#include "core/geometry/types.hpp"

namespace evbench {

/// Ideal pinhole: pixel = (fx x/z + cx, fy y/z + cy), camera z forward, x right, y down.
struct PinholeCamera {
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;  ///< [px]

  Vector2 project(const Vector3& point) const {
    return {fx * point.x() / point.z() + cx, fy * point.y() / point.z() + cy};
  }
  /// ∂pixel/∂point, at point.z() ≠ 0.
  Matrix23 project_jacobian(const Vector3& point) const;
  /// The ray (x, y, 1) of a pixel.
  Vector3 ray(const Vector2& pixel) const { return {(pixel.x() - cx) / fx, (pixel.y() - cy) / fy, 1.0}; }
};

/// Model of the lens distortion.
enum class DistortionModel {
  none,
  radial_tangential,  ///< k1 k2 p1 p2 k3 (OpenCV's order of the first five)
  equidistant,        ///< k1 k2 k3 k4 on the angle θ (Kannala-Brandt, OpenCV's fisheye)
};

DistortionModel parse_distortion_model(const std::string& name);  ///< throws InputError with the known names
std::string to_string(DistortionModel model);

/// A calibrated camera: pinhole, lens distortion, sensor size.
struct Camera {
  PinholeCamera pinhole;
  DistortionModel distortion = DistortionModel::none;
  Eigen::Matrix<double, 5, 1> coefficients = Eigen::Matrix<double, 5, 1>::Zero();
  int width = 0, height = 0;  ///< [px]

  /// Raw (distorted) pixel of a point in camera coordinates, z > 0.
  Vector2 project(const Vector3& point) const;

  /// The ideal pinhole's pixel of a raw one, by Newton's method to 1e-12 in normalised coordinates. None where the lens
  /// model cannot be inverted (far outside its valid range).
  std::optional<Vector2> undistort(const Vector2& raw) const;

  /// ∂raw/∂ideal at an ideal pinhole's pixel.
  Matrix2 distortion_jacobian(const Vector2& ideal) const;

  /// Is the pixel on the sensor, at least `margin` pixels from its border?
  bool contains(const Vector2& pixel, double margin = 0.0) const {
    return pixel.x() >= margin && pixel.y() >= margin && pixel.x() <= width - 1 - margin &&
           pixel.y() <= height - 1 - margin;
  }
};

/// Throws InputError with the place of the option if a border [px] leaves nothing of the image.
void check_border(double border, const Camera& camera, const std::string& place);

}  // namespace evbench
