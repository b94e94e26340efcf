#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/plugin/options.hpp"
#include "core/plugin/status.hpp"
#include "core/support/json.hpp"
#include "eval/association.hpp"
#include "eval/run_settings.hpp"

namespace evbench {

/// A trajectory segment: part of the estimate in one world frame and scale.
struct RunSegment {
  double from = 0.0, to = 0.0;  ///< [s]
  std::size_t poses = 0, landmarks = 0;
};

/// Status of a run: status.json, and the key "status" of metrics.json.
struct RunStatus {
  Status status;
  std::vector<TimeRange> stationary;  ///< stationary periods
  std::vector<RunSegment> segments;   ///< in time order; empty if there is no estimate
  std::size_t scored = 0;             ///< number of the scored segment, from 1; 0: none
  /// False: the run broke off (a plugin threw an exception). It is repeated when it is requested again.
  bool complete = true;
};

/// Wall time of each of many steps [ms].
struct StepTimes {
  double median = 0.0, p99 = 0.0, max = 0.0;
};
/// `seconds`: of each step. None if there is no step.
std::optional<StepTimes> step_times(std::vector<double> seconds);

/// Wall time of a run by part [s].
struct RecordedTimes {
  double source = 0.0;                    ///< the front-end waits for events
  double frontend = 0.0;                  ///< front-end
  double backend = 0.0;                   ///< back-end
  double waiting = 0.0;                   ///< the back-end's thread waits for the front-end's
  double harness = 0.0;                   ///< the rest: exchanges, undistortion, hashing, sampling
  double total = 0.0;                     ///< from the first exchange to the last estimate
  std::optional<double> slowest_5s = {};  ///< data / processing time of the slowest 5 s while running; none: shorter
  std::optional<StepTimes> frontend_ms = {};  ///< of each batch of observations
  std::optional<StepTimes> backend_ms = {};   ///< of each update of the estimate
};

/// The reason why a run of a sequence without ground truth has no scores.
inline constexpr const char* kNoGroundTruth = "no ground truth";

/// Record of a run: metrics.json (docs/reference/metrics.md) and its folder. `evbench eval` fills in only the scores;
/// unknown values are empty, and null in the file.
struct RunRecord {
  std::string experiment;  ///< runs of one experiment are compared with one another
  std::string label;       ///< the run's name within it
  std::optional<std::uint64_t> seed;
  std::string key;                        ///< of the job: runs of one key have the same trajectory; empty: not known
  std::optional<std::uint64_t> position;  ///< in its config's list of back-ends, from 0; none: it had no list
  std::string folder;                     ///< not in the file
  RunSettings settings;                   ///< of its config.json, if there is one; not in the file
  RunAxes axes;                           ///< its place in a sweep, if it belongs to one; not in the file
  bool done = true;                       ///< false: planned by a sweep, but not run; not in the file
  std::string damage;                     ///< why a sweep's run can't be read (then done is false); not in the file
  Json final_scores, causal_scores;       ///< from to_json(Scores); null: none
  Json covariance;                        ///< {kind: from to_json(CovarianceScores)}; null: none
  Json track_scores;                      ///< from score_tracks(); null: no truth is known
  Json common_scores;                     ///< over the common time of all runs of a table; not in the file
  std::string final_unscored, causal_unscored;  ///< why there are no scores; kNoGroundTruth: no run can have any
  std::optional<TimeRange> range;               ///< [s] time range of the run: nothing outside is scored
  std::optional<double> runtime_s;              ///< processing time: front-end and back-end
  std::optional<double> data_s;                 ///< time from the first to the last observation
  std::optional<double> realtime_factor;        ///< data_s / runtime_s
  std::optional<RecordedTimes> times;
  std::optional<double> peak_rss_mib;
  Json
      events;  ///< what happened, in order of report: [{"t": [s], "kind": a word, "text": a sentence}]; null: not known
  Json counters;  ///< what the back-end counted: {name: number}; null: not known
  std::optional<RunStatus> status;

  /// Whether it is ranked against others. Lost and failed runs aren't, nor those that were not run.
  bool competes() const { return done && (!status || status->status.state < RunState::lost); }
};

/// The contents of metrics.json and status.json. The same record gives an identical file.
Json to_json(const RunRecord& record);
/// metrics.json without the scores, "final", "causal" and "covariance", which are most of it.
Json to_json_without_scores(const RunRecord& record);
Json to_json(const RunStatus& status);

/// Reads a record from the contents of metrics.json. Unknown keys are skipped; messages begin with `place`. Written
/// again, the file is identical. Throws InputError for a key that is missing or has a wrong type: experiment, label,
/// final and causal are required, the others may be missing or null.
RunRecord read_record(const Json& metrics, const std::string& place);

/// Reads a run's folder: metrics.json, and the settings in config.json. Throws InputError, also for a file that is
/// missing or not JSON.
RunRecord read_record(const std::string& folder);

}  // namespace evbench
