#pragma once

#include <optional>

#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"
#include "core/geometry/so3.hpp"

namespace evbench {

/// A point as direction from the world's origin and inverse distance: the point direction/inverse, which may be at any
/// distance.
struct InversePoint {
  Vector3 direction = Vector3::UnitZ();
  double inverse = 1.0;

  Vector3 position() const { return direction / inverse; }
};

/// The loss of Geman and McClure, c²/2 e²/(e² + c²), as a function of e², and its weight in least squares. It is
/// bounded: all gross errors cost the same.
struct BoundedLoss {
  double width = 1.0;  ///< c

  double operator()(double squared) const { return 0.5 * width * width * squared / (squared + width * width); }
  double weight(double squared) const {
    const double share = width * width / (squared + width * width);
    return share * share;
  }
};

/// Reprojection error of a point, predicted minus observed pixel [px], with its derivatives.
struct PointImage {
  Vector2 error = Vector2::Zero();
  Eigen::Matrix<double, 2, 6> pose = Eigen::Matrix<double, 2, 6>::Zero();  ///< T ← T Exp(δ)
  Matrix23 direction = Matrix23::Zero();
  Vector2 inverse = Vector2::Zero();
};

/// The point in camera coordinates, times its distance from the origin: Rᵀ (direction − inverse p).
inline Vector3 seen_from(const SE3& T, const InversePoint& point) {
  return T.q.conjugate() * (point.direction - point.inverse * T.p);
}

/// Reprojection error [px]; none behind the camera.
inline std::optional<Vector2> image_error(const SE3& T, const InversePoint& point, const Vector2& pixel,
                                          const PinholeCamera& camera) {
  constexpr double kNear = 1e-3;
  const Vector3 q = seen_from(T, point);
  if (!(q.z() > kNear)) return std::nullopt;
  return Vector2(camera.project(q) - pixel);
}

inline std::optional<PointImage> point_image(const SE3& T, const InversePoint& point, const Vector2& pixel,
                                             const PinholeCamera& camera) {
  const auto error = image_error(T, point, pixel, camera);
  if (!error) return std::nullopt;
  const Vector3 q = seen_from(T, point);
  const Matrix23 J = camera.project_jacobian(q);
  PointImage result;
  result.error = *error;
  result.pose << J * so3::hat(q), -point.inverse * J;
  result.direction = J * T.R().transpose();
  result.inverse = -result.direction * T.p;
  return result;
}

}  // namespace evbench
