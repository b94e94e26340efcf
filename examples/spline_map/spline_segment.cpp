#include "spline_segment.hpp"

#include <evbench/plugin.hpp>

namespace spline_map {
namespace so3 = evbench::so3;

Knot::Knot(const Eigen::Quaterniond& rotation, const Vector3& position) {
  Eigen::Map<Eigen::Vector4d>{values} = rotation.coeffs();
  Eigen::Map<Vector3>{values + 4} = position;
}

Knot Knot::moved(const Vector6& tangent) const {
  const Vector3 turn = tangent.head<3>(), shift = tangent.tail<3>();
  return {(rotation() * so3::exp(turn)).normalized(), position() + shift};
}

BasisWeights::BasisWeights(const std::array<double, 3>& steps)
    : cumulative(steps), plain{-steps[0], steps[0] - steps[1], steps[1] - steps[2], steps[2]} {}

BasisWeights::BasisWeights(double u)
    : BasisWeights(std::array{(5.0 + u * (3.0 + u * (-3.0 + u))) / 6.0, (1.0 + u * (3.0 + u * (3.0 - 2.0 * u))) / 6.0,
                              u * u * u / 6.0}) {
  plain[0] += 1.0;
}

BasisWeights BasisWeights::derivative(double u) {
  return BasisWeights(std::array{0.5 * (1.0 - 2.0 * u + u * u), 0.5 * (1.0 + 2.0 * u - 2.0 * u * u), 0.5 * u * u});
}

SplineSegment::SplineSegment(const Knot& k0, const Knot& k1, const Knot& k2, const Knot& k3) : first_(k0.rotation()) {
  const std::array knots{&k0, &k1, &k2, &k3};
  for (std::size_t j = 0; j < 4; ++j) positions_[j] = knots[j]->position();
  for (std::size_t j = 0; j < 3; ++j) {
    steps_[j] = so3::log(knots[j]->rotation().conjugate() * knots[j + 1]->rotation());
    right_inverse_[j] = so3::right_jacobian_inverse(steps_[j]);
    left_inverse_[j] = right_inverse_[j].transpose();
  }
}

Vector3 SplineSegment::position(const std::array<double, 4>& weights) const {
  return weights[0] * positions_[0] + weights[1] * positions_[1] + weights[2] * positions_[2] +
         weights[3] * positions_[3];
}

SE3 SplineSegment::pose(double u) const {
  const BasisWeights weights(u);
  Eigen::Quaterniond rotation = first_;
  for (std::size_t j = 0; j < 3; ++j) rotation = rotation * so3::exp(weights.cumulative[j] * steps_[j]);
  return {rotation.normalized(), position(weights.plain)};
}

SE3 SplineSegment::pose(double u, Jacobians& jacobians) const {
  const BasisWeights weights(u);
  std::array<Eigen::Quaterniond, 3> factors;
  for (std::size_t j = 0; j < 3; ++j) factors[j] = so3::exp(weights.cumulative[j] * steps_[j]);
  // The later factors transform a factor's increment to the end: (Exp(..)..)ᵀ.
  Matrix3 after = Matrix3::Identity();
  for (auto& block : jacobians.rotation) block.setZero();
  for (std::size_t j = 3; j-- > 0;) {
    const Matrix3 slope =
        weights.cumulative[j] * after * so3::right_jacobian(weights.cumulative[j] * steps_[j]);  // ∂(increment)/∂d_j
    jacobians.rotation[j + 1] += slope * right_inverse_[j];
    jacobians.rotation[j] -= slope * left_inverse_[j];
    after = after * factors[j].conjugate().toRotationMatrix();
  }
  jacobians.rotation[0] += after;
  jacobians.position = weights.plain;
  return {(first_ * factors[0] * factors[1] * factors[2]).normalized(), position(weights.plain)};
}

Vector6 SplineSegment::velocity(double u) const {
  const BasisWeights weights(u), rates = BasisWeights::derivative(u);
  Vector3 angular = Vector3::Zero();
  Eigen::Quaterniond rotation = first_;
  for (std::size_t j = 0; j < 3; ++j) {
    const Eigen::Quaterniond factor = so3::exp(weights.cumulative[j] * steps_[j]);
    angular = factor.conjugate() * angular + rates.cumulative[j] * steps_[j];
    rotation = rotation * factor;
  }
  Vector6 result;
  result << angular, rotation.conjugate() * position(rates.plain);
  return result;
}

}  // namespace spline_map
