#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/motion/pose_trajectory.hpp"

namespace evbench {

/// A pose of the causal estimate, and when it was known.
struct CausalPose : StampedPose {
  /// [s] The time of the data from which it was made: what was observed up to then is in it, nothing later. None: the
  /// end of the batch that was being taken.
  std::optional<double> known_at = {};
  /// Body velocity (ω, ν), with which the back-end would predict. None: that between its newest poses.
  std::optional<Vector6> velocity = {};
};

/// A file of them, a line each in the order in which they were told: known_at t x y z qx qy qz qw, then the velocity
/// where there is one. Numbers read back as the same.
std::string format_causal_poses(std::span<const CausalPose> poses);

/// Throws InputError, with file and line, for a damaged file and for times known_at that decrease.
std::vector<CausalPose> read_causal_poses(const std::string& path);

}  // namespace evbench
