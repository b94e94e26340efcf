#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/motion/body_velocities.hpp"
#include "core/motion/pose_trajectory.hpp"
#include "eval/statistics.hpp"

namespace evbench {

/// Body velocity (ω [rad/s], ν [m/s]) of a trajectory at t by differentiation of its poses: the slope at t of the cubic
/// in ξ(τ) that fits T(τ) = T(t) Exp(ξ(τ)) best, by least squares, over the poses within 50 ms of t, and at least over
/// the two nearest on each side. T(t) is fitted, too. None where one of these is farther than 0.5 s.
std::optional<Vector6> differentiate(const PoseTrajectory& trajectory, double t);

/// Velocities of ground truth and estimate at one time, at one scale.
struct VelocityPair {
  Vector6 ground_truth, estimate;
};

/// Relative velocity errors ‖v − v̂‖ / ‖v‖ over some times. Undefined without motion.
struct RelativeVelocityError {
  /// Area under the share of times with an error below a threshold, for thresholds from 0 to 1 (500 values); each time
  /// weighs as much as its speed ‖v‖. 1 is the best.
  double auc = Statistics::kUndefined;
  double median = Statistics::kUndefined;  ///< over the times with motion, unweighted
};

struct VelocityErrors {
  RelativeVelocityError linear, angular;
  std::size_t times = 0;
};
/// As the EvSLAM benchmark (Zhong et al. 2026) computes RVE and its AUC.
VelocityErrors velocity_errors(std::span<const VelocityPair> pairs);

/// Of a trajectory, by its own velocities if it states any, and by differentiation of its poses.
struct VelocityScores {
  std::optional<VelocityErrors> own;
  VelocityErrors differentiated;
};

}  // namespace evbench
