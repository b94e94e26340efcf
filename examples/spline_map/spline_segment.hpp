#pragma once

#include <array>
#include <evbench/plugin.hpp>

namespace spline_map {

using evbench::Matrix3;
using evbench::SE3;
using evbench::Vector2;
using evbench::Vector3;
using evbench::Vector6;

/// A control point of the spline: rotation and position of the camera in the world (x y z w; x y z), in Ceres' memory
/// layout. Its tangent is (φ, δ): R ← R Exp(φ), p ← p + δ, the increment of the position in the world frame.
struct Knot {
  double values[7] = {0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0};

  Knot() = default;
  Knot(const Eigen::Quaterniond& rotation, const Vector3& position);
  explicit Knot(const SE3& T) : Knot(T.q, T.p) {}

  Eigen::Quaterniond rotation() const { return {values[3], values[0], values[1], values[2]}; }
  Vector3 position() const { return {values[4], values[5], values[6]}; }
  Knot moved(const Vector6& tangent) const;
};

/// Weights of a uniform cubic B-spline at u ∈ [0, 1] of a segment, and their derivatives with respect to u.
struct BasisWeights {
  std::array<double, 3> cumulative;  ///< of the steps between neighbouring knots: B̃_1, B̃_2, B̃_3
  std::array<double, 4> plain;       ///< of the four knots; they sum to one
  explicit BasisWeights(double u);
  static BasisWeights derivative(double u);

 private:
  explicit BasisWeights(const std::array<double, 3>& steps);
};

/// One segment of a cumulative cubic B-spline: between the second and the third of four knots.
///
/// Split representation, SO(3) × R³ (Sommer et al. 2020, Ovrén and Forssén 2019), not SE(3) (Mueggler et al. 2018):
///   R(u) = R_0 Exp(B̃_1 d_1) Exp(B̃_2 d_2) Exp(B̃_3 d_3), d_j = Log(R_{j−1}ᵀ R_j);   p(u) = Σ_j B_j p_j.
/// The camera's position is then a polynomial that does not depend on its rotation, derivatives of the position are
/// constants, and the penalised acceleration is the true one.
///
/// Terms that depend only on the knots are computed once and shared by all observations in the segment.
class SplineSegment {
 public:
  SplineSegment() = default;
  SplineSegment(const Knot& k0, const Knot& k1, const Knot& k2, const Knot& k3);

  SE3 pose(double u) const;

  /// The pose with derivatives with respect to the knots' tangents. The rotation's right increment at u is
  /// Σ_j rotation[j] φ_j; the position's is Σ_j position[j] δ_j (scalars: the same for all three axes).
  struct Jacobians {
    std::array<Matrix3, 4> rotation;
    std::array<double, 4> position;
  };
  SE3 pose(double u, Jacobians& jacobians) const;

  /// Body velocity (ω, ν) with respect to u: divide by the knot spacing for [rad/s, units/s].
  Vector6 velocity(double u) const;

 private:
  Eigen::Quaterniond first_ = Eigen::Quaterniond::Identity();
  std::array<Vector3, 4> positions_;
  std::array<Vector3, 3> steps_;
  std::array<Matrix3, 3> right_inverse_, left_inverse_;  ///< J_r(d_j)⁻¹, J_l(d_j)⁻¹

  Vector3 position(const std::array<double, 4>& weights) const;
};

}  // namespace spline_map
