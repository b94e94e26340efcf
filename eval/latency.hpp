#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/data/causal_poses.hpp"

namespace evbench {

/// How old the newest pose was whenever one was told that was newer than all before [s]: the time between an event and
/// a trajectory that has seen it, data time.
struct Delay {
  double median = 0.0, p99 = 0.0, max = 0.0;
};
/// None where nothing was told.
std::optional<Delay> delay_of(std::span<const CausalPose> told);

/// What a back-end would have given at each of the times t (rising) for t itself, `latency` [s] later: from the poses
/// that it had told as known by t + latency, of each time as it was told last. By the same rule for every back-end:
/// - between poses of a time before t and after it, interpolation (PoseTrajectory);
/// - after the newest one, constant body velocity: the back-end's own where it was told, else that since the newest
///   pose that is at least 20 ms older; no farther than a second, after which there is none;
/// - before the first one there is none.
PoseTrajectory estimates_at_latency(std::span<const CausalPose> told, std::span<const double> times, double latency);

}  // namespace evbench
