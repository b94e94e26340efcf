#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench/sweep/plan.hpp"
#include "bench/sweep/sweep_file.hpp"
#include "eval/run_record.hpp"

namespace evbench {

/// Optional outputs of a run.
struct RunOutputs {
  bool problem = false, tracks = false;

  /// Whether the requested outputs are in a run's folder.
  bool are_in(const std::string& folder) const;
};

struct ExecutorOptions {
  std::string out = "results";
  int processes = 1;  ///< at a time
  RunLimits limits;
  bool retry_failed = false;  ///< redo interrupted and damaged runs
  bool force = false;         ///< redo complete runs, too
  RunOutputs outputs = {};    ///< a complete run without them is done again
};

/// A run that failed, or in which tracking was lost.
struct TroubledRun {
  std::string label;
  std::string place;   ///< its values on the axes: "seed=3, frames=0.1"
  std::string reason;  ///< "lost at 12.3 s: ...", "timeout after 60 s", ...
  bool lost = false;   ///< there is an estimate, but not to the end of the data
};

/// The line "failed: LABEL, AXIS=VALUE: reason".
std::string describe(const TroubledRun& run);

/// Of a run's result; none for a success.
std::optional<TroubledRun> trouble_of(const RunRecord& record, const std::string& place);

/// Progress of a sweep.
struct SweepProgress {
  std::size_t runs = 0;       ///< number of different jobs
  std::size_t before = 0;     ///< complete when the sweep began
  std::size_t done = 0;       ///< including those from before and failed ones
  std::size_t running = 0;    ///< here
  std::size_t elsewhere = 0;  ///< done by another process
  std::size_t failed = 0;
  std::vector<TroubledRun> troubled;
  double seconds_left = 0.0;  ///< expected [s]; 0: not known
};

/// "3 of 8 done, 1 failed, 2 running, about 5 min left".
std::string describe(const SweepProgress& progress);

/// Takes the runs that are complete below `out`, with the plan's names and scores, and returns the runs that are left
/// to do, each job once. These include interrupted and damaged runs where `retry_failed` is set.
std::vector<PlannedRun> runs_to_do(const std::vector<PlannedRun>& runs, const Plugins& plugins,
                                   const ExecutorOptions& options);

/// Does runs, each in a process of its own with limits. Runs that are complete below `out` are taken instead, with the
/// plan's names and scores. A run that crashes, hangs or exceeds its limits leaves a normal run folder with the status
/// failed and the reason. An interrupted or damaged run is only reported, unless its retry is requested. A run that was
/// killed from outside is retried once. Runs of another process are waited for, and taken over when that process ends
/// without a result. So any number of processes on machines that share the folder can do one sweep.
///
/// The tracks of a front-end that begins with events and takes no feedback are made once for the runs that share them
/// (PlannedRun::tracks), in a process of its own, and kept in `out`/.tracks/NAME. Results are the same byte by byte,
/// and their times are the front-end's own. Simulated events that several runs need (PlannedRun::events) are likewise
/// made once, in `out`/.events/NAME. They are removed when the last of these runs is done, by any process
/// (PlannedRun::events_for). Runs of the same events follow one another, so that there are at most about as many
/// recordings as processes.
///
/// `progress` is called several times a second. Throws OutputError when results can't be written, and Interrupted.
/// Complete runs then stay, and no partial result is left.
SweepProgress do_runs(const std::vector<PlannedRun>& runs, const Plugins& plugins, const ExecutorOptions& options,
                      const std::function<void(const SweepProgress&)>& progress);

}  // namespace evbench
