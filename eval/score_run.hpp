#pragma once

#include <string>

#include "eval/run_record.hpp"
#include "eval/scores.hpp"

namespace evbench {

/// Reads a run's final.tum or causal.tum; empty if the run has no trajectory.
PoseTrajectory read_estimate(const std::string& path);

/// An estimate of a run, as it was written.
struct RunEstimate {
  PoseTrajectory poses;       ///< empty if the run has no trajectory
  BodyVelocities velocities;  ///< as the back-end states them; empty if it does not
};
RunEstimate read_run_estimate(const std::string& folder, bool causal);

/// Scores the files of a run's folder, final.tum, velocities.txt, causal.tum, causal_poses.txt (at zero and at equal
/// latency) and covariance.txt, against groundtruth.tum. Sets the record's scores, or the reason why there are none (no
/// groundtruth.tum, no trajectory, too few poses to compare). Ground truth outside of the record's range is not used.
/// Scores depend only on the written files, so that scoring again gives identical digits. Throws InputError for missing
/// or damaged files.
void score_run(const std::string& folder, const ScoreOptions& options, RunRecord& record);

/// Scores one of the trajectories in the same way; the result is as in metrics.json. A reason why there are no scores
/// is an InputError here.
Json scores_of(const std::string& folder, bool causal, const ScoreOptions& options, const RunRecord& record);

/// An estimate of a run, and its scores.
struct ScoredEstimate {
  PoseTrajectory estimate;
  Scores scores;
};

/// The same without latencies and covariances, with the estimate.
ScoredEstimate score_estimate(const std::string& folder, bool causal, const ScoreOptions& options,
                              const RunRecord& record);

}  // namespace evbench
