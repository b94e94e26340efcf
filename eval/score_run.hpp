#pragma once

#include <string>

#include "eval/run_record.hpp"
#include "eval/scores.hpp"

namespace evbench {

/// A run's final.tum or causal.tum; empty where the run has no trajectory.
PoseTrajectory read_estimate(const std::string& path);

/// Scores what lies in a run's folder, final.tum, causal.tum, causal_poses.txt (at zero and at equal latency) and
/// covariance.txt against groundtruth.tum: sets the record's scores, or why there are none (no groundtruth.tum, no
/// trajectory, too few poses to compare). Ground truth outside of the record's range is not used. So the scores of a
/// run are of what it wrote, and come out the same, digit by digit, when it is scored again. Throws InputError for
/// files that are missing or damaged.
void score_run(const std::string& folder, const ScoreOptions& options, RunRecord& record);

/// One of the estimates, scored likewise, as metrics.json has it; what score_run() takes down as the reason why there
/// are no scores is an InputError here.
Json scores_of(const std::string& folder, bool causal, const ScoreOptions& options, const RunRecord& record);

/// An estimate of a run, and its scores.
struct ScoredEstimate {
  PoseTrajectory estimate;
  Scores scores;
};

/// Likewise the scores of the estimate alone, with the estimate.
ScoredEstimate score_estimate(const std::string& folder, bool causal, const ScoreOptions& options,
                              const RunRecord& record);

}  // namespace evbench
