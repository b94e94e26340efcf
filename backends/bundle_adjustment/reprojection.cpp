#include "backends/bundle_adjustment/reprojection.hpp"

#include "core/geometry/so3.hpp"
#include "core/geometry/tangent_plane.hpp"

namespace evbench::bundle_adjustment {
namespace {

constexpr double kNearestDepth = 1e-6;

using Vector7 = Eigen::Matrix<double, 7, 1>;
template <int Rows, int Columns>
using RowMajor = Eigen::Matrix<double, Rows, Columns, Eigen::RowMajor>;

SE3 read(const double* x) { return {Eigen::Quaterniond(x[3], x[0], x[1], x[2]), Vector3(x[4], x[5], x[6])}; }

void write(const SE3& T, double* x) {
  Eigen::Map<Vector7> values(x);
  values << T.q.coeffs(), T.p;
}

}  // namespace

PoseBlock::PoseBlock(const SE3& T) { write(T, values); }
SE3 PoseBlock::pose() const {
  SE3 T = read(values);
  T.q.normalize();
  return T;
}

Vector2 reprojection_error(const SE3& T, const Vector3& landmark, const Vector2& pixel, const PinholeCamera& camera) {
  const Vector3 local = T.q.conjugate() * (landmark - T.p);
  if (!(local.z() > kNearestDepth)) return Vector2::Constant(2.0 * camera.fx);
  return camera.project(local) - pixel;
}

Vector2 reprojection_error(const SE3& T, const Vector3& landmark, const Vector2& pixel, const PinholeCamera& camera,
                           ReprojectionJacobians& J) {
  const Matrix3 Rt = T.R().transpose();
  const Vector3 local = Rt * (landmark - T.p);
  if (!(local.z() > kNearestDepth)) {
    J.pose.setZero();
    J.landmark.setZero();
    return Vector2::Constant(2.0 * camera.fx);
  }
  const Matrix23 projection = camera.project_jacobian(local);
  J.pose.leftCols<3>() = projection * so3::hat(local);
  J.pose.rightCols<3>() = -projection;
  J.landmark = projection * Rt;
  return camera.project(local) - pixel;
}

bool ReprojectionCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const SE3 T = read(parameters[0]);
  const Vector3 landmark = Eigen::Map<const Vector3>(parameters[1]);
  Eigen::Map<Vector2> residual(residuals);
  if (jacobians == nullptr) {
    residual = whitening_ * reprojection_error(T, landmark, pixel_, camera_);
    return true;
  }
  ReprojectionJacobians J;
  residual = whitening_ * reprojection_error(T, landmark, pixel_, camera_, J);
  if (jacobians[0] != nullptr) {
    Eigen::Map<RowMajor<2, 7>> pose(jacobians[0]);
    pose.leftCols<6>() = whitening_ * J.pose;
    pose.col(6).setZero();
  }
  if (jacobians[1] != nullptr) {
    Eigen::Map<RowMajor<2, 3>> position(jacobians[1]);
    position = whitening_ * J.landmark;
  }
  return true;
}

bool PoseManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  write(read(x) * se3::exp(Eigen::Map<const Vector6>(delta)), x_plus_delta);
  return true;
}

bool PoseManifold::PlusJacobian(const double*, double* jacobian) const {
  Eigen::Map<RowMajor<7, 6>>(jacobian).setIdentity();
  return true;
}

bool PoseManifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  Eigen::Map<Vector6> difference(y_minus_x);
  difference = se3::log(read(x).inverse() * read(y));
  return true;
}

bool PoseManifold::MinusJacobian(const double*, double* jacobian) const {
  Eigen::Map<RowMajor<6, 7>>(jacobian).setIdentity();
  return true;
}

Eigen::Matrix<double, 3, 2> FixedDistanceManifold::basis(const Vector3& position) const {
  return tangent_plane((position - centre_).normalized());
}

bool FixedDistanceManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  SE3 T = read(x);
  const double distance = (T.p - centre_).norm();
  const Vector3 moved = T.p + basis(T.p) * Eigen::Map<const Vector2>(delta + 3) - centre_;
  T.p = centre_ + distance * moved.normalized();
  T.q = (T.q * so3::exp(Eigen::Map<const Vector3>(delta))).normalized();
  write(T, x_plus_delta);
  return true;
}

bool FixedDistanceManifold::PlusJacobian(const double* x, double* jacobian) const {
  const SE3 T = read(x);
  Eigen::Map<RowMajor<7, 5>> J(jacobian);
  J.setZero();
  J.topLeftCorner<3, 3>().setIdentity();
  J.block<3, 2>(3, 3) = T.R().transpose() * basis(T.p);
  return true;
}

bool FixedDistanceManifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  const SE3 from = read(x), to = read(y);
  Eigen::Map<Vector3> rotation(y_minus_x);
  Eigen::Map<Vector2> translation(y_minus_x + 3);
  rotation = so3::log(from.q.conjugate() * to.q);
  // The inverse of Plus: the intersection of the ray to `to` with the tangent plane at `from`.
  const Vector3 radius = from.p - centre_, ray = to.p - centre_;
  translation = basis(from.p).transpose() * (radius.squaredNorm() / ray.dot(radius) * ray);
  return true;
}

bool FixedDistanceManifold::MinusJacobian(const double* x, double* jacobian) const {
  RowMajor<7, 5> plus;
  PlusJacobian(x, plus.data());
  Eigen::Map<RowMajor<5, 7>> J(jacobian);
  J = plus.transpose();
  return true;
}

std::unique_ptr<ceres::LossFunction> make_loss(const std::string& kind, double width) {
  if (kind == "huber") return std::make_unique<ceres::HuberLoss>(width);
  if (kind == "cauchy") return std::make_unique<ceres::CauchyLoss>(width);
  return nullptr;
}

}  // namespace evbench::bundle_adjustment
