#pragma once

#include <string>

#include "eval/run_record.hpp"
#include "eval/scores.hpp"

namespace evbench {

/// Which of a run's estimates.
struct EstimateName {
  bool causal = false;
  std::string segment = {};  ///< ".segment2": of a trajectory segment that is not the scored one
};

/// Reads final.tum or causal.tum of a run's folder; empty if the run has no trajectory.
PoseTrajectory read_run_poses(const std::string& folder, const EstimateName& name);

/// The velocities in the camera's frame as the back-end states them; empty if it does not.
BodyVelocities read_run_velocities(const std::string& folder, const EstimateName& name);

/// An estimate of a run, as it was written: both of these.
struct RunEstimate {
  PoseTrajectory poses;
  BodyVelocities velocities;
};
RunEstimate read_run_estimate(const std::string& folder, const EstimateName& name);

/// Scores the files of a run's folder, final.tum, velocities.txt, causal.tum, causal_poses.txt (at zero and at equal
/// latency) and covariance.txt, against groundtruth.tum. Sets the record's scores, or the reason why there are none (no
/// groundtruth.tum, no trajectory, too few poses to compare). Ground truth outside of the record's range is not used.
/// Scores depend only on the written files, so that scoring again gives identical digits. Throws InputError for missing
/// or damaged files.
void score_run(const std::string& folder, const ScoreOptions& options, RunRecord& record);

/// Scores one of the trajectories in the same way; the result is as in metrics.json. A reason why there are no scores
/// is an InputError here.
Json scores_of(const std::string& folder, bool causal, const ScoreOptions& options, const RunRecord& record);

/// Scores poses of a run against its ground truth, within the run's time range. Throws InputError with the reason if
/// there are no scores.
Scores score_poses(const PoseTrajectory& ground_truth, const PoseTrajectory& estimate, ScoreOptions options,
                   const RunRecord& record);

/// An estimate of a run, and its scores.
struct ScoredEstimate {
  PoseTrajectory estimate;
  Scores scores;
};

/// The same without latencies and covariances, with the estimate.
ScoredEstimate score_estimate(const std::string& folder, bool causal, const ScoreOptions& options,
                              const RunRecord& record);

}  // namespace evbench
