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

/// A run of a sweep, and all that determines its result.
struct PlannedRun {
  RunConfig config;
  JobIdentity identity;
  RunAxes axes;  ///< its value on each axis, in their order
  /// Name of its front-end's tracks, where these are made from events and other runs of the sweep need the same: ten
  /// digits of the SHA-256 of the job without its back-end. Empty: the run makes them for itself.
  std::string tracks;
  /// Likewise the name of its source and seed, where its front-end takes events that are in no file and other runs need
  /// the same: ten digits of the SHA-256 of that part of the job.
  std::string events;
  /// Keys of runs of other processes that need the same events: these stay until all of the runs are done.
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

/// Makes and checks every config of the sweep, and computes the keys. Each source is made once in another process, with
/// the sweep's limits, to learn the files that it reads. A job may have several places in a sweep, under several
/// labels. Throws InputError, with the sweep's place, for an invalid value, and for two places of one job that
/// differ in protocol: it is one run.
SweepPlan plan_sweep(const Sweep& sweep, const Plugins& plugins);

/// Sets PlannedRun::tracks and PlannedRun::events of runs that need the same. `events_in_files`: whether the job's
/// source reads its events from files.
void share_what_is_made_of_events(std::vector<PlannedRun>& runs, const Plugins& plugins,
                                  const std::function<bool(const Job&)>& events_in_files);

/// The runs with one of these values, "AXIS=VALUE", on each axis that is named. Throws InputError for an axis or value
/// that the plan doesn't have, with the nearest axis or all values.
std::vector<PlannedRun> select_runs(const SweepPlan& plan, const std::vector<std::string>& only);

}  // namespace evbench
