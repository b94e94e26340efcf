#pragma once

#include "eval/scores.hpp"

namespace evbench {

/// The time offset [s], at most `reach` from the protocol's, that makes the root mean square of the position errors
/// smallest, to 0.1 ms. Ground truth is interpolated, so that the error changes smoothly; all else is by `options`.
/// Throws InputError where score() does at every offset.
double fit_time_offset(const PoseTrajectory& ground_truth, const PoseTrajectory& estimate, ScoreOptions options,
                       double reach);

}  // namespace evbench
