#pragma once

#include <span>
#include <string>
#include <vector>

#include "bench/figures/figure.hpp"
#include "eval/run_record.hpp"
#include "eval/scores.hpp"

namespace evbench {

/// Options of figures of runs.
struct FigureOptions {
  std::vector<std::string> metrics = {};  ///< a panel each, as in tables; empty: ATE and RPE
  std::string axis = "";                  ///< of sweeps: a name of run_columns(); empty: the one that has numbers alone
  std::string axis_label = "";            ///< what is written there; empty: the axis' name
  std::string across = "";                ///< of maps: the column that is the other axis
  std::string base = "";                  ///< of maps: the method to compare with; empty: the one without axis
  bool causal = false;                    ///< the scores of the causal trajectories, instead of the final ones
};

/// Scored trajectories of one sequence, from any source.
struct ScoredTrajectories {
  std::vector<std::string> names;  ///< one each
  std::vector<Scores> scores;
  std::string caption;
  bool numbered = false;  ///< poses have numbers, not times
};

/// Their errors over time; their coordinates over time, and their views from three sides, with the ground truth.
Figure error_figure(const ScoredTrajectories& scored);
Figure position_figure(const ScoredTrajectories& scored);
Figure trajectory_figure(const ScoredTrajectories& scored);

// All throw InputError where there is nothing to draw, saying what was expected. Failed runs are shown: as a number
// above a sweep's panel or behind a box's name, as a share that is not reached in a profile, in the caption elsewhere.

/// Metrics against an axis: a curve for each method (eval/methods.hpp) through the medians of its other runs, a band
/// between their quartiles. A method that does not have the axis is a level across.
Figure sweep_figure(std::span<const RunRecord> runs, const FigureOptions& options);

/// A map of ratios against two axes of numbers: the median over the runs at a point of the metric of the method that
/// has the axis, divided by the metric of the base on the same data.
Figure map_figure(std::span<const RunRecord> runs, const FigureOptions& options);

/// A box for each method: quartiles, median, and each run.
Figure box_figure(std::span<const RunRecord> runs, const FigureOptions& options);

/// Performance profiles (eval/performance_profile.hpp): a problem is data that all methods have a run on.
Figure profile_figure(std::span<const RunRecord> runs, const FigureOptions& options);

/// Distribution of update times: the share of updates that took at most a time, in runs that succeeded.
Figure times_figure(std::span<const RunRecord> runs, const FigureOptions& options);

/// Errors over time of the runs of one sequence, translation above rotation, aligned as they were scored. Of several
/// sequences the first is drawn, and the caption says which.
Figure error_figure(std::span<const RunRecord> runs, const FigureOptions& options);

/// The three coordinates over time of the trajectories of one sequence, likewise, with the ground truth.
Figure position_figure(std::span<const RunRecord> runs, const FigureOptions& options);

/// Trajectories of one sequence from three sides, aligned as they were scored, with the ground truth; of several
/// likewise.
Figure trajectory_figure(std::span<const RunRecord> runs, const FigureOptions& options);

}  // namespace evbench
