#pragma once

#include <span>
#include <string>

#include "core/geometry/similarity.hpp"
#include "eval/score_run.hpp"

namespace evbench {

/// Poses of an estimate at given times, as text: a line `t x y z qx qy qz qw` each, with `velocity` followed by the
/// linear velocity `vx vy vz` in the camera's frame.
struct PoseSamples {
  std::string text;
  std::size_t left_out = 0;   ///< times at which there is no pose or velocity
  bool own_velocity = false;  ///< as the back-end states it; else the poses are differentiated
};

/// `alignment` is applied to poses and velocities. `times` are on the clock of the ground truth, that of the estimate
/// plus `time_offset` [s].
PoseSamples sample_poses(const RunEstimate& estimate, const Similarity& alignment, double time_offset,
                         std::span<const double> times, bool velocity);

}  // namespace evbench
