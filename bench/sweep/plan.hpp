#pragma once

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "bench/experiment.hpp"
#include "bench/sweep/sweep_file.hpp"
#include "eval/run_settings.hpp"

namespace evbench {

/// A run of a sweep, and what determines its result.
struct PlannedRun {
  RunConfig config;
  JobIdentity identity;
  RunAxes axes;  ///< its value on each axis, in their order
  /// Names what its front-end gives, where that is made from events and other runs of the sweep need the same: the
  /// SHA-256 of the job without its back-end, ten digits of it. Empty: the run makes it for itself.
  std::string tracks;
  /// Likewise names its source and seed, where its front-end begins with events that no file holds, and other runs do,
  /// too: ten digits of the SHA-256 of that part of the job.
  std::string events;
  /// Keys of runs that other processes do and that need the same events, which stay until all of them are done.
  std::vector<std::string> events_for;
};

/// Values on axes: "seed=3, frames=0.1".
std::string place_of(const RunAxes& axes);

/// All runs of a sweep, in order: grid by grid, the last axis varies fastest, then the config's back-ends.
struct SweepPlan {
  std::string name;                                                    ///< of the experiment
  std::vector<std::pair<std::string, std::vector<std::string>>> axes;  ///< and all of their values
  std::vector<PlannedRun> runs;
  std::vector<std::string> remarks;  ///< on its config, for who wrote it

  /// The sweep as JSON, {"name", "axes": [{"name", "values"}], "runs": [{"key", "label", "axes": {AXIS: VALUE}}]}: what
  /// is written as sweep.json, so that tables know the axes, and that nothing is missing.
  Json to_json() const;
};

/// Makes every config of the sweep, checks it, and finds the keys; each source is made once, for the files that it
/// reads, in another process, with the sweep's limits for each. A job may have several places in a sweep, under several
/// labels. Throws InputError, with the sweep's place, for a value that can't be, and for two places of one job that
/// differ in protocol: it is one run.
SweepPlan plan_sweep(const Sweep& sweep, const Plugins& plugins);

/// Sets PlannedRun::tracks and PlannedRun::events of runs that need the same. `events_in_files`: does the job's source
/// read its events from files?
void share_what_is_made_of_events(std::vector<PlannedRun>& runs, const Plugins& plugins,
                                  const std::function<bool(const Job&)>& events_in_files);

/// The runs with one of these values, "AXIS=VALUE", on each axis that is named. Throws InputError for an axis or value
/// that the plan doesn't have, with the nearest axis or all values.
std::vector<PlannedRun> select_runs(const SweepPlan& plan, const std::vector<std::string>& only);

}  // namespace evbench
