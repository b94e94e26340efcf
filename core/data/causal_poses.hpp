#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/motion/pose_trajectory.hpp"

namespace evbench {

/// A published pose of the causal estimate, with the time at which it was known.
struct CausalPose : StampedPose {
  /// [s] Data time at which the pose was known: it includes all observations up to this time and nothing later. None:
  /// the end of the current batch.
  std::optional<double> known_at = {};
  /// Body velocity (ω, ν) for predicting later poses. None: the velocity between the newest poses is used.
  std::optional<Vector6> velocity = {};
};

/// The content of causal_poses.txt, a line per pose in the order of publication: known_at t x y z qx qy qz qw, then the
/// velocity if there is one. Numbers are read back unchanged.
std::string format_causal_poses(std::span<const CausalPose> poses);

/// Reads such a file. Throws InputError with file and line for a damaged file and for decreasing known_at.
std::vector<CausalPose> read_causal_poses(const std::string& path);

}  // namespace evbench
