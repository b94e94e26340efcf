#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/data/problem.hpp"
#include "core/smoother/batch_solver.hpp"
#include "core/smoother/smoother.hpp"

namespace evbench::smoother {

enum class SolveMode { incremental, batch, fixed_lag };

struct SolveOptions {
  SolveMode mode = SolveMode::incremental;
  SmootherOptions engine;
  MotionPrior motion_prior;  ///< the file has its QC alone
  double lag = 2.0;          ///< [s], fixed-lag mode
  int max_iterations = 20;   ///< batch mode
};

struct SolveResult {
  FactorGraph graph;  ///< with the final estimate, complete
  std::vector<double> step_ms;
  std::vector<UpdateSummary> updates;  ///< one a step; empty in batch mode
  double total_s = 0.0;                ///< of the steps
  double peak_mib = 0.0;               ///< of the process when the last step was done
  std::string reason;                  ///< of the last step that had one
};

/// Solves a problem by the protocol of problem files: step 0 adds state 0 and its priors; step k ≥ 1 adds state k,
/// started at the motion expected from the newest estimate, T_{k−1} Exp(Δt ϖ_{k−1}) for WNOA, and every observation of
/// (t_{k−1}, t_k]. A landmark enters with its second observation, its prior and the observations held back until then.
/// A step's time is that of adding its data, updating, and reading the newest state. In batch mode a step is one solve
/// from the initial guess of the file.
SolveResult solve_problem(const Problem& problem, const SolveOptions& options);

/// (cost of the estimate − cost after a batch solve from there) / the latter; with the oracle's estimate for
/// comparison.
struct Check {
  double relative_excess = 0.0;
  FactorGraph optimum;
};
Check check_against_batch(const FactorGraph& estimate);

}  // namespace evbench::smoother
