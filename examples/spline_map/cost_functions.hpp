#pragma once

#include <ceres/evaluation_callback.h>
#include <ceres/manifold.h>
#include <ceres/sized_cost_function.h>

#include <evbench/plugin.hpp>
#include <vector>

#include "spline.hpp"

namespace spline_map {

/// The prepared segments of a spline for one evaluation by Ceres. Ceres writes the values into the knots and calls
/// this; the cost functions of observations then share the terms that are the same for a whole segment.
class PreparedSegments : public ceres::EvaluationCallback {
 public:
  /// Segments from `first` on. The spline must outlive this and keep its number of knots.
  PreparedSegments(const Spline& spline, std::size_t first);
  void PrepareForEvaluation(bool evaluate_jacobians, bool new_point) override;
  const SplineSegment& operator[](std::size_t segment) const { return segments_[segment]; }

 private:
  const Spline& spline_;
  std::size_t first_;
  std::vector<SplineSegment> segments_;
};

/// Manifold of a knot. Jacobians with respect to a knot have those of its tangent in the first six of seven columns.
class KnotManifold : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;
};

/// Reprojection error h(T⁻¹ℓ) − z [px]. Behind the camera it is 2 fx, constant.
Vector2 reprojection_error(const SE3& T, const Vector3& landmark, const Vector2& pixel,
                           const evbench::PinholeCamera& camera);

/// Whitened reprojection error of a landmark (last block) from a position in a segment of four knots.
class ReprojectionCost : public ceres::SizedCostFunction<2, 7, 7, 7, 7, 3> {
 public:
  /// `segment` is prepared from the knots that are the parameters.
  ReprojectionCost(const SplineSegment& segment, double u, const evbench::UndistortedObservation& z,
                   const evbench::PinholeCamera& camera)
      : segment_(segment), u_(u), pixel_(z.pixel), whitening_(z.noise.whitening()), camera_(camera) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  const SplineSegment& segment_;
  double u_;
  Vector2 pixel_;
  evbench::Whitening whitening_;
  const evbench::PinholeCamera& camera_;
};

/// The same from a fixed pose.
class HeldReprojectionCost : public ceres::SizedCostFunction<2, 3> {
 public:
  HeldReprojectionCost(const SE3& T, const evbench::UndistortedObservation& z, const evbench::PinholeCamera& camera)
      : T_(T), pixel_(z.pixel), whitening_(z.noise.whitening()), camera_(camera) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  SE3 T_;
  Vector2 pixel_;
  evbench::Whitening whitening_;
  const evbench::PinholeCamera& camera_;
};

/// Acceleration at the middle one of three knots, (d_2 − d_1)/Δt² with steps d_j = (Log(R_{j−1}ᵀR_j), p_j − p_{j−1}),
/// over its standard deviation: √(density/Δt) for white noise of a power spectral density.
class AccelerationCost : public ceres::SizedCostFunction<6, 7, 7, 7> {
 public:
  /// `rotation` [rad²/s³] and `translation` [units²/s³]: densities; `spacing` [s] of the knots.
  AccelerationCost(double rotation, double translation, double spacing);
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  double rotation_, translation_;  ///< weights of d_2 − d_1
};

/// (Log(R_priorᵀ R), p − p_prior)/sigma of the pose at the beginning of a segment: fixes the world frame.
class PoseAnchorCost : public ceres::SizedCostFunction<6, 7, 7, 7, 7> {
 public:
  PoseAnchorCost(const SE3& T, double sigma) : T_(T), weight_(1.0 / sigma) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  SE3 T_;
  double weight_;
};

/// log(distance/expected)/sigma of the camera's positions at two times: fixes the scale. A position is linear in the
/// knots, so the cost has a weight for each knot that the two times depend on.
class BaselineCost : public ceres::CostFunction {
 public:
  /// `weights`: of each parameter block's position in p(t1) − p(t0).
  BaselineCost(std::vector<double> weights, double expected, double sigma);
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  std::vector<double> weights_;
  double expected_, weight_;
};

}  // namespace spline_map
