#pragma once

#include <vector>

#include "core/motion/pose_trajectory.hpp"

namespace evbench {

/// A twice continuously differentiable curve through given poses, in rotation and translation. It differs from the
/// motion models of all back-ends, so simulations with it favour none.
///
/// Each inner pose T_i has an arc T_i Exp(v τ + a τ²), τ = t − t_i, that passes through both of its neighbours. Between
/// two poses the curve blends the left pose's arc L into the right pose's arc R:
/// T(t) = L Exp(w(s) Log(L⁻¹R)) with w(s) = 10 s³ − 15 s⁴ + 6 s⁵. As w' and w'' are zero at both ends, pose, velocity
/// and acceleration at T_i are those of its own arc, from either side. The first and the last interval have one arc
/// only; two poses are joined by constant velocity.
class PoseSpline {
 public:
  /// At least one pose.
  explicit PoseSpline(const PoseTrajectory& trajectory);

  /// The pose at t; outside the given times the outermost arc is extrapolated.
  SE3 at(double t) const;

 private:
  /// T Exp(v τ + a τ²), τ = time − t.
  struct Arc {
    double t;
    SE3 T;
    Vector6 v, a;

    SE3 at(double time) const;
  };
  static Arc arc(const StampedPose& before, const StampedPose& centre, const StampedPose& after);
  static Arc line(const StampedPose& from, const StampedPose& to);

  std::vector<Arc> arcs_;  ///< one per inner pose; for fewer than three poses the line that joins them
};

}  // namespace evbench
