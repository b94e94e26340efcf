#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/support/json.hpp"
#include "eval/score_run.hpp"

namespace evbench::report {

/// A trajectory of a run, and its scores if it has any.
struct ScoredTrajectory {
  RunEstimate estimate = {};
  std::optional<Scores> scores = {};
  std::string unscored = {};  ///< why it has none

  Similarity alignment() const { return scores ? scores->alignment.transform : Similarity(); }
  double offset() const { return scores ? scores->options.time_offset : 0.0; }  ///< [s] added to its times
};

/// Reads one of a run's trajectories and scores it. Damaged files are left out, and `damage` gets the reasons.
ScoredTrajectory read_scored(const RunRecord& run, const EstimateName& name, const PoseTrajectory& truth,
                             const ScoreOptions& protocol, std::vector<std::string>& damage);

/// A trajectory as the page reads it (bench/report/page/src/data.ts, Trajectory): at most about `most` poses, their
/// velocities by differentiation.
Json trajectory_json(const PoseTrajectory& trajectory, std::size_t most);

/// An aligned trajectory with the velocities that the back-end states, and with its absolute errors (Estimate).
Json estimate_json(const ScoredTrajectory& scored, std::size_t most);

}  // namespace evbench::report
