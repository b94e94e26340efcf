#include "cost_functions.hpp"

#include <cmath>
#include <evbench/plugin.hpp>
#include <utility>

namespace spline_map {
namespace {

namespace so3 = evbench::so3;
using evbench::Matrix23;

template <int Rows, int Columns>
using RowMajor = Eigen::Matrix<double, Rows, Columns, Eigen::RowMajor>;

constexpr double kNearestDepth = 1e-6;

Knot read(const double* x) { return {Eigen::Quaterniond(x[3], x[0], x[1], x[2]), Vector3(x[4], x[5], x[6])}; }

}  // namespace

PreparedSegments::PreparedSegments(const Spline& spline, std::size_t first)
    : spline_(spline), first_(first), segments_(spline.segments()) {
  PrepareForEvaluation(true, true);
}

void PreparedSegments::PrepareForEvaluation(bool, bool new_point) {
  if (!new_point) return;
  for (std::size_t s = first_; s < segments_.size(); ++s) segments_[s] = spline_.segment(s);
}

bool KnotManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  const Knot moved = read(x).moved(Eigen::Map<const Vector6>(delta));
  std::copy(moved.values, moved.values + 7, x_plus_delta);
  return true;
}

bool KnotManifold::PlusJacobian(const double*, double* jacobian) const {
  Eigen::Map<RowMajor<7, 6>>(jacobian).setIdentity();
  return true;
}

bool KnotManifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  const Knot to = read(y), from = read(x);
  Eigen::Map<Vector6>{y_minus_x} << so3::log(from.rotation().conjugate() * to.rotation()),
      to.position() - from.position();
  return true;
}

bool KnotManifold::MinusJacobian(const double*, double* jacobian) const {
  Eigen::Map<RowMajor<6, 7>>(jacobian).setIdentity();
  return true;
}

Vector2 reprojection_error(const SE3& T, const Vector3& landmark, const Vector2& pixel,
                           const evbench::PinholeCamera& camera) {
  const Vector3 local = T.q.conjugate() * (landmark - T.p);
  if (!(local.z() > kNearestDepth)) return Vector2::Constant(2.0 * camera.fx);
  return camera.project(local) - pixel;
}

bool ReprojectionCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const Vector3 landmark = Eigen::Map<const Vector3>(parameters[4]);
  Eigen::Map<Vector2> residual(residuals);
  if (jacobians == nullptr) {
    residual = whitening_ * reprojection_error(segment_.pose(u_), landmark, pixel_, camera_);
    return true;
  }
  SplineSegment::Jacobians J;
  const SE3 T = segment_.pose(u_, J);
  const Matrix3 Rt = T.R().transpose();
  const Vector3 local = Rt * (landmark - T.p);
  const bool visible = local.z() > kNearestDepth;
  residual = visible ? Vector2(whitening_ * Vector2(camera_.project(local) - pixel_))
                     : Vector2::Constant(2.0 * whitening_.inverse_sigma() * camera_.fx);
  const Matrix23 projection = visible ? Matrix23(whitening_ * camera_.project_jacobian(local)) : Matrix23::Zero();
  const Matrix23 by_rotation = projection * so3::hat(local), by_landmark = projection * Rt;
  for (std::size_t j = 0; j < 4; ++j) {
    if (jacobians[j] == nullptr) continue;
    Eigen::Map<RowMajor<2, 7>> knot(jacobians[j]);
    knot.leftCols<3>().noalias() = by_rotation * J.rotation[j];
    knot.middleCols<3>(3) = -J.position[j] * by_landmark;
    knot.col(6).setZero();
  }
  if (jacobians[4] != nullptr) Eigen::Map<RowMajor<2, 3>>{jacobians[4]} = by_landmark;
  return true;
}

bool HeldReprojectionCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const Vector3 landmark = Eigen::Map<const Vector3>(parameters[0]);
  Eigen::Map<Vector2>{residuals} = whitening_ * reprojection_error(T_, landmark, pixel_, camera_);
  if (jacobians == nullptr || jacobians[0] == nullptr) return true;
  Eigen::Map<RowMajor<2, 3>> J(jacobians[0]);
  const Matrix3 Rt = T_.R().transpose();
  const Vector3 local = Rt * (landmark - T_.p);
  J.setZero();
  if (local.z() > kNearestDepth) J = whitening_ * Matrix23(camera_.project_jacobian(local) * Rt);
  return true;
}

AccelerationCost::AccelerationCost(double rotation, double translation, double spacing)
    : rotation_(1.0 / std::sqrt(rotation * spacing * spacing * spacing)),
      translation_(1.0 / std::sqrt(translation * spacing * spacing * spacing)) {}

bool AccelerationCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const Knot k0 = read(parameters[0]), k1 = read(parameters[1]), k2 = read(parameters[2]);
  const Vector3 d1 = so3::log(k0.rotation().conjugate() * k1.rotation());
  const Vector3 d2 = so3::log(k1.rotation().conjugate() * k2.rotation());
  Eigen::Map<Vector6>{residuals} << rotation_ * (d2 - d1),
      translation_ * (k2.position() - 2.0 * k1.position() + k0.position());
  if (jacobians == nullptr) return true;
  const std::array<Matrix3, 3> turns{so3::left_jacobian_inverse(d1),
                                     -so3::left_jacobian_inverse(d2) - so3::right_jacobian_inverse(d1),
                                     so3::right_jacobian_inverse(d2)};
  constexpr std::array kShifts{1.0, -2.0, 1.0};
  for (std::size_t j = 0; j < 3; ++j) {
    if (jacobians[j] == nullptr) continue;
    Eigen::Map<RowMajor<6, 7>> J(jacobians[j]);
    J.setZero();
    J.topLeftCorner<3, 3>() = rotation_ * turns[j];
    J.block<3, 3>(3, 3) = translation_ * kShifts[j] * Matrix3::Identity();
  }
  return true;
}

bool PoseAnchorCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const SplineSegment segment(read(parameters[0]), read(parameters[1]), read(parameters[2]), read(parameters[3]));
  SplineSegment::Jacobians J;
  const SE3 T = segment.pose(0.0, J);
  const Vector3 turn = so3::log(T_.q.conjugate() * T.q);
  Eigen::Map<Vector6>{residuals} << weight_ * turn, weight_ * (T.p - T_.p);
  if (jacobians == nullptr) return true;
  const Matrix3 by_rotation = weight_ * so3::right_jacobian_inverse(turn);
  for (std::size_t j = 0; j < 4; ++j) {
    if (jacobians[j] == nullptr) continue;
    Eigen::Map<RowMajor<6, 7>> knot(jacobians[j]);
    knot.setZero();
    knot.topLeftCorner<3, 3>() = by_rotation * J.rotation[j];
    knot.block<3, 3>(3, 3) = weight_ * J.position[j] * Matrix3::Identity();
  }
  return true;
}

BaselineCost::BaselineCost(std::vector<double> weights, double expected, double sigma)
    : weights_(std::move(weights)), expected_(expected), weight_(1.0 / sigma) {
  set_num_residuals(1);
  mutable_parameter_block_sizes()->assign(weights_.size(), 7);
}

bool BaselineCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  Vector3 baseline = Vector3::Zero();
  for (std::size_t i = 0; i < weights_.size(); ++i) baseline += weights_[i] * read(parameters[i]).position();
  const double distance = baseline.norm();
  if (!(distance > 0.0)) return false;
  residuals[0] = weight_ * std::log(distance / expected_);
  if (jacobians == nullptr) return true;
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    if (jacobians[i] == nullptr) continue;
    Eigen::Map<RowMajor<1, 7>> J(jacobians[i]);
    J.setZero();
    J.middleCols<3>(3) = weight_ * weights_[i] / (distance * distance) * baseline.transpose();
  }
  return true;
}

}  // namespace spline_map
