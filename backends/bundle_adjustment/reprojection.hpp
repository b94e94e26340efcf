#pragma once

#include <ceres/loss_function.h>
#include <ceres/manifold.h>
#include <ceres/sized_cost_function.h>

#include <memory>
#include <span>
#include <string>

#include "core/geometry/camera.hpp"
#include "core/geometry/pixel_noise.hpp"
#include "core/geometry/se3.hpp"

namespace evbench::bundle_adjustment {

/// A pose as a parameter block of Ceres: x y z w of the quaternion, then the translation (the memory of SE3 may have
/// gaps).
struct PoseBlock {
  double values[7];

  PoseBlock() : PoseBlock(SE3{}) {}
  explicit PoseBlock(const SE3& T);
  SE3 pose() const;
};

/// Reprojection error [px] of a landmark in a camera at T = T_world_camera, h(T⁻¹ℓ) − z. Behind the camera it is 2 fx,
/// constant.
Vector2 reprojection_error(const SE3& T, const Vector3& landmark, const Vector2& pixel, const PinholeCamera& camera);

/// The error with its derivatives with respect to the right increment of T and to the landmark.
struct ReprojectionJacobians {
  Matrix26 pose;
  Matrix23 landmark;
};
Vector2 reprojection_error(const SE3& T, const Vector3& landmark, const Vector2& pixel, const PinholeCamera& camera,
                           ReprojectionJacobians& J);

/// The whitened error. Jacobians with respect to a PoseBlock are those of the right increment in the first six
/// columns, which is what the manifolds below expect.
class ReprojectionCost : public ceres::SizedCostFunction<2, 7, 3> {
 public:
  ReprojectionCost(const Vector2& pixel, const PixelNoise& noise, const PinholeCamera& camera)
      : pixel_(pixel), whitening_(noise.whitening()), camera_(camera) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  Vector2 pixel_;
  Whitening whitening_;
  PinholeCamera camera_;
};

/// T ← T Exp(δ).
class PoseManifold : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;
};

/// A pose whose distance from `centre` is kept, which anchors the scale: R ← R Exp(φ), and the position moves on the
/// sphere along two tangent directions.
class FixedDistanceManifold : public ceres::Manifold {
 public:
  explicit FixedDistanceManifold(const Vector3& centre) : centre_(centre) {}
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 5; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;

 private:
  Vector3 centre_;
  Eigen::Matrix<double, 3, 2> basis(const Vector3& position) const;
};

/// "none" (null), "huber" or "cauchy", on whitened residuals; `width` in sigmas.
std::unique_ptr<ceres::LossFunction> make_loss(const std::string& kind, double width);

}  // namespace evbench::bundle_adjustment
