#include "core/geometry/camera.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/support/error.hpp"

namespace evbench {
namespace {

using Coefficients = Eigen::Matrix<double, 5, 1>;

struct Bent {
  Vector2 point;
  Matrix2 jacobian;  // ∂point/∂(normalised coordinates)
};

Bent radial_tangential(const Vector2& n, const Coefficients& k) {
  const double x = n.x(), y = n.y();
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  const double d_radial = k[0] + r2 * (2.0 * k[1] + 3.0 * r2 * k[4]);  // with respect to r²
  const double p1 = k[2], p2 = k[3];
  Bent result;
  result.point << x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
      y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y;
  const double cross = 2.0 * x * y * d_radial + 2.0 * p1 * x + 2.0 * p2 * y;
  result.jacobian << radial + 2.0 * x * x * d_radial + 2.0 * p1 * y + 6.0 * p2 * x, cross, cross,
      radial + 2.0 * y * y * d_radial + 6.0 * p1 * y + 2.0 * p2 * x;
  return result;
}

Bent equidistant(const Vector2& n, const Coefficients& k) {
  const double r = n.norm();
  if (r < 1e-8) return {n, Matrix2::Identity()};
  const double theta = std::atan(r);
  const double t2 = theta * theta;
  const double bent = theta * (1.0 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
  const double d_bent = 1.0 + t2 * (3.0 * k[0] + t2 * (5.0 * k[1] + t2 * (7.0 * k[2] + t2 * 9.0 * k[3])));
  const double scale = bent / r;
  const double d_scale = (d_bent / (1.0 + r * r) - scale) / r;  // ∂scale/∂r
  return {scale * n, scale * Matrix2::Identity() + (d_scale / r) * n * n.transpose()};
}

Bent bend(DistortionModel model, const Vector2& n, const Coefficients& k) {
  switch (model) {
    case DistortionModel::radial_tangential: return radial_tangential(n, k);
    case DistortionModel::equidistant: return equidistant(n, k);
    case DistortionModel::none: break;
  }
  return {n, Matrix2::Identity()};
}

}  // namespace

Matrix23 PinholeCamera::project_jacobian(const Vector3& point) const {
  const double iz = 1.0 / point.z();
  Matrix23 j;
  j << fx * iz, 0.0, -fx * point.x() * iz * iz, 0.0, fy * iz, -fy * point.y() * iz * iz;
  return j;
}

DistortionModel parse_distortion_model(const std::string& name) {
  for (const DistortionModel model :
       {DistortionModel::none, DistortionModel::radial_tangential, DistortionModel::equidistant}) {
    if (name == to_string(model)) return model;
  }
  throw InputError(
      fmt::format("unknown distortion model \"{}\"; expected none, radial_tangential or equidistant", name));
}

std::string to_string(DistortionModel model) {
  switch (model) {
    case DistortionModel::radial_tangential: return "radial_tangential";
    case DistortionModel::equidistant: return "equidistant";
    case DistortionModel::none: break;
  }
  return "none";
}

Vector2 Camera::project(const Vector3& point) const {
  const Vector2 bent = bend(distortion, point.hnormalized(), coefficients).point;
  return pinhole.project(bent.homogeneous());
}

std::optional<Vector2> Camera::undistort(const Vector2& raw) const {
  if (distortion == DistortionModel::none) return raw;
  const Vector2 target = pinhole.ray(raw).head<2>();
  Vector2 n = target;
  if (distortion == DistortionModel::equidistant) {  // start from the undistorted angle: tan grows fast
    const double r = target.norm();
    if (r >= M_PI_2) return std::nullopt;
    if (r > 1e-8) n *= std::tan(r) / r;
  }
  constexpr int kMaxIterations = 30;
  for (int i = 0; i < kMaxIterations; ++i) {
    const Bent bent = bend(distortion, n, coefficients);
    // Beyond the maximum of the polynomial the model folds back and has no inverse.
    if (!(bent.jacobian.determinant() > 1e-6)) return std::nullopt;
    const Vector2 step = bent.jacobian.inverse() * (target - bent.point);
    n += step;
    if (!n.allFinite() || n.squaredNorm() > 1e4) return std::nullopt;
    if (step.squaredNorm() < 1e-24) return pinhole.project(n.homogeneous());
  }
  return std::nullopt;
}

Matrix2 Camera::distortion_jacobian(const Vector2& ideal) const {
  if (distortion == DistortionModel::none) return Matrix2::Identity();
  const Vector2 focal(pinhole.fx, pinhole.fy);
  const Vector2 n = pinhole.ray(ideal).head<2>();
  return focal.asDiagonal() * bend(distortion, n, coefficients).jacobian * focal.cwiseInverse().asDiagonal();
}

void check_border(double border, const Camera& camera, const std::string& place) {
  if (2.0 * border < std::min(camera.width, camera.height) - 1) return;
  throw InputError(
      fmt::format("{}: {} px leave nothing of an image of {} x {}", place, border, camera.width, camera.height));
}

}  // namespace evbench
