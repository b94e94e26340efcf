#pragma once

#include "bench/report/scored_trajectory.hpp"
#include "bench/report/thinning.hpp"

namespace evbench::report {

/// The newest poses as they were published, with standard deviations from covariance.txt, aligned as the smoothed
/// estimate is (bench/report/page/src/data.ts, Newest): of the position along the world's axes [m], and of roll, pitch
/// and yaw [deg]. They are relative to the back-end's first pose. Null without covariances. Throws InputError for
/// damaged files.
Json newest_json(const RunRecord& run, const ScoredTrajectory& scored, const PoseTrajectory& truth,
                 const Budget& budget);

}  // namespace evbench::report
