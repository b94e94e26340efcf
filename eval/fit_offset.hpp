#pragma once

#include "eval/scores.hpp"

namespace evbench {

struct OffsetFit {
  double offset = 0.0;   ///< [s]
  bool at_edge = false;  ///< of the reach: the error may be smaller beyond
};

/// The time offset, at most `reach` [s] from the protocol's, that makes the root mean square of the position errors
/// smallest, to 0.1 ms, among those with at least 90 % of the most pairs. Ground truth is interpolated, so that the
/// error changes smoothly; all else is by `options`. Throws InputError where score() does at every offset.
OffsetFit fit_time_offset(const PoseTrajectory& ground_truth, const PoseTrajectory& estimate, ScoreOptions options,
                          double reach);

}  // namespace evbench
