#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench/sweep/plan.hpp"
#include "bench/sweep/sweep_file.hpp"
#include "eval/run_record.hpp"

namespace evbench {

/// What is written of a run only where it is asked for.
struct RunOutputs {
  bool problem = false, tracks = false;

  /// Are those that are asked for in a run's folder?
  bool are_in(const std::string& folder) const;
};

struct ExecutorOptions {
  std::string out = "results";
  int processes = 1;  ///< at a time
  RunLimits limits;
  bool retry_failed = false;  ///< do runs again that broke off, and damaged ones
  bool force = false;         ///< and complete ones
  RunOutputs outputs = {};    ///< a complete run without them is done again
};

/// A run whose result is a failure, or that was lost.
struct TroubledRun {
  std::string label;
  std::string place;   ///< its values on the axes: "seed=3, frames=0.1"
  std::string reason;  ///< "lost at 12.3 s: ...", "timeout after 60 s", ...
  bool lost = false;   ///< there is an estimate, but not to the end
};

/// A line: "failed: LABEL, AXIS=VALUE: reason".
std::string describe(const TroubledRun& run);

/// Of a run's result; none where all is well.
std::optional<TroubledRun> trouble_of(const RunRecord& record, const std::string& place);

/// How far a sweep is.
struct SweepProgress {
  std::size_t runs = 0;       ///< of different jobs
  std::size_t before = 0;     ///< complete when it began
  std::size_t done = 0;       ///< now, those from before included, and those that failed
  std::size_t running = 0;    ///< here
  std::size_t elsewhere = 0;  ///< another process does them
  std::size_t failed = 0;
  std::vector<TroubledRun> troubled;
  double seconds_left = 0.0;  ///< expected [s]; 0: not known
};

/// "3 of 8 done, 1 failed, 2 running, about 5 min left".
std::string describe(const SweepProgress& progress);

/// Takes the runs that are complete below `out`, named and scored as the plan says, and returns the others, each job
/// once: those to be done, with those that broke off or are damaged where `retry_failed` asks for them.
std::vector<PlannedRun> runs_to_do(const std::vector<PlannedRun>& runs, const Plugins& plugins,
                                   const ExecutorOptions& options);

/// Does runs, each in a process of its own with limits; those that are complete below `out` are taken instead, named
/// and scored as the plan says. A run that crashes, hangs or takes too much leaves a folder like any other, failed,
/// with the reason. One that broke off or is damaged is not done again but told, unless that is asked for. One that was
/// killed from outside is tried a second time. Runs that another process is doing are waited for, and taken over when
/// that process ends without a result: any number of processes on machines that share the folder may do one sweep.
///
/// What a front-end gives that begins with events and takes no feedback is made once for the runs that share it
/// (PlannedRun::tracks), in a process of its own, and kept in `out`/.tracks/NAME; results are the same, byte by byte,
/// and their times the front-end's own. Simulated events that several runs need (PlannedRun::events) are likewise made
/// once, in `out`/.events/NAME, and removed when the last of these runs is done, whoever does it
/// (PlannedRun::events_for); runs of the same events follow one another, so that there are at most about as many
/// recordings as processes.
///
/// `progress` is called several times a second. Throws OutputError when results can't be written, and Interrupted; what
/// was complete by then stays, and nothing is half.
SweepProgress do_runs(const std::vector<PlannedRun>& runs, const Plugins& plugins, const ExecutorOptions& options,
                      const std::function<void(const SweepProgress&)>& progress);

}  // namespace evbench
