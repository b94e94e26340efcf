#pragma once

#include <limits>

namespace evbench {

/// The Gaussian process on SE(3) that joins control states, for each axis of the body velocity ϖ:
///   white noise on acceleration (WNOA; Barfoot 2014, Dong 2017):  ϖ' = w
///   Singer's prior (Wong et al. 2020):                            ϖ' = a,  a' = −α (a − w)
/// with w ~ GP(0, Qc δ(t − t')). Singer's acceleration is WNOA's, smoothed over a time of 1/α: over much longer times
/// the priors agree, with the same Qc. Without it an acceleration tends to zero at the rate α, and has the stationary
/// variance α Qc/2.
struct MotionPrior {
  double rate = std::numeric_limits<double>::infinity();  ///< α [1/s] > 0; infinite: WNOA

  /// Do control states have an acceleration?
  bool has_acceleration() const { return rate < std::numeric_limits<double>::infinity(); }
  /// Time derivatives of the pose in a control state, the pose included.
  int orders() const { return has_acceleration() ? 3 : 2; }
  /// Rows of a control state's increment: (pose, velocity), and then acceleration.
  int state_size() const { return 6 * orders(); }

  bool operator==(const MotionPrior&) const = default;
};

/// Weights of what determines the motion between two states in its position at a time, or in a derivative of it: the
/// velocity and acceleration at the begin, and position, velocity and acceleration at the end, all in the tangent space
/// of the begin, where its position is zero. Without accelerations their weights are zero.
struct InterpolationWeights {
  double velocity0, end, end_velocity;
  double acceleration0 = 0.0, end_acceleration = 0.0;
};

}  // namespace evbench
