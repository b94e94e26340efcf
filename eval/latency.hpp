#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/data/causal_poses.hpp"

namespace evbench {

/// Delay of the newest pose at each time when one was published that is newer than all before: known_at − t [s], data
/// time.
struct Delay {
  double median = 0.0, p99 = 0.0, max = 0.0;
};
/// None if no pose was published.
std::optional<Delay> delay_of(std::span<const CausalPose> published);

/// The estimates for each of the times t (rising) that were available `latency` [s] later: from the poses known by
/// t + latency, for each time the last one published. The same rule applies to every back-end:
/// - between poses before and after t: interpolation (PoseTrajectory);
/// - after the newest pose: constant body velocity, the published one if there is one, else that since the newest pose
///   that is at least 20 ms older; for at most a second, after which there is no estimate;
/// - before the first pose there is no estimate.
PoseTrajectory estimates_at_latency(std::span<const CausalPose> published, std::span<const double> times,
                                    double latency);

}  // namespace evbench
