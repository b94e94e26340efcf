#pragma once

#include <vector>

#include "core/motion/gp_interval.hpp"

namespace evbench {

/// A continuous-time trajectory: control states joined by the WNOA prior's interpolation.
class GpTrajectory {
 public:
  GpTrajectory() = default;

  /// Control states at strictly increasing times; throws InputError otherwise.
  explicit GpTrajectory(std::vector<ControlState> states);

  const std::vector<ControlState>& states() const { return states_; }
  bool empty() const { return states_.empty(); }
  double start() const { return states_.front().t; }
  double end() const { return states_.back().t; }

  /// Pose and velocity at any t; outside [start, end] by constant body velocity. Not of an empty trajectory.
  ControlState at(double t) const;

 private:
  std::vector<ControlState> states_;
};

/// The state dt [s] later (or earlier) at constant body velocity: T Exp(dt ϖ).
ControlState extrapolate(const ControlState& state, double dt);

}  // namespace evbench
