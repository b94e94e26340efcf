#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/plugin/options.hpp"
#include "core/support/json.hpp"
#include "core/plugin/status.hpp"
#include "eval/association.hpp"
#include "eval/run_settings.hpp"

namespace evbench {

/// A part of the estimate in one world frame and scale.
struct RunSegment {
  double from = 0.0, to = 0.0;  ///< [s]
  std::size_t poses = 0, landmarks = 0;
};

/// How a run went: status.json, and the key "status" of metrics.json.
struct RunStatus {
  Status status;
  std::vector<TimeRange> still;  ///< spans in which the camera stood still
  std::vector<RunSegment> segments;  ///< in time order; none when there is no estimate
  std::size_t scored = 0;        ///< the number of the segment that is scored, from 1; 0: none
  /// False: the run broke off (a plugin threw an exception). It is done again when it is asked for again.
  bool complete = true;
};

/// How long each of many equal steps took [ms], wall clock.
struct StepTimes {
  double median = 0.0, p99 = 0.0, max = 0.0;
};
/// None where there was no step. `seconds`: of each.
std::optional<StepTimes> step_times(std::vector<double> seconds);

/// Where the time of a run went [s], wall clock.
struct RecordedTimes {
  double source = 0.0;                    ///< the front-end's waiting for events
  double frontend = 0.0;                  ///< making observations
  double backend = 0.0;                   ///< estimating
  double waiting = 0.0;                   ///< the back-end's thread, for the front-end's
  double harness = 0.0;                   ///< the rest: exchanges, undistortion, hashing, sampling
  double total = 0.0;                     ///< from the first exchange to the last estimate
  std::optional<double> slowest_5s = {};  ///< data / processing time of the slowest 5 s while running; none: shorter
  std::optional<StepTimes> frontend_ms = {};  ///< of each batch of observations
  std::optional<StepTimes> backend_ms = {};   ///< of each update of the estimate
};

/// Why a run of a sequence without ground truth has no scores.
inline constexpr const char* kNoGroundTruth = "no ground truth";

/// What is known of a run that was done: metrics.json (docs/reference/metrics.md) and where it was found. `evbench eval` fills in the
/// scores alone; what it doesn't know is empty, and null in the file.
struct RunRecord {
  std::string experiment;  ///< runs of one experiment are compared with one another
  std::string label;       ///< the run's name within it
  std::optional<std::uint64_t> seed;
  std::string key;                        ///< of the job: runs of one key have the same trajectory; empty: not known
  std::optional<std::uint64_t> position;  ///< in its config's list of back-ends, from 0; none: it had no list
  std::string folder;                     ///< where it lies; not in the file
  RunSettings settings;                   ///< of its config.json, where there is one; not in the file
  RunAxes axes;                           ///< its place in a sweep, where it is of one; not in the file
  bool done = true;                       ///< false: a sweep has planned it, and it was not run; not in the file
  std::string damage;                     ///< of a sweep's run that can't be read, done then being false: why
  Json final_scores, causal_scores;       ///< as to_json(Scores) gives them; null: none
  Json covariance;                        ///< {kind: as to_json(CovarianceScores) gives it}; null: none
  Json common_scores;                     ///< over the time that all runs of a table cover; not in the file
  std::string final_unscored, causal_unscored;  ///< why there are no scores; kNoGroundTruth: nobody could have any
  std::optional<TimeRange> range;               ///< [s] of the sequence that was run: nothing outside is scored
  std::optional<double> runtime_s;              ///< processing time: front-end and back-end
  std::optional<double> data_s;                 ///< time of the sequence that was given
  std::optional<double> realtime_factor;        ///< data_s / runtime_s
  std::optional<RecordedTimes> times;
  std::optional<double> peak_rss_mib;
  std::optional<RunStatus> status;

  /// Is it measured against others? Lost and failed runs aren't, nor those that were not run.
  bool competes() const { return done && (!status || status->status.state < RunState::lost); }
};

/// The contents of metrics.json and of status.json. The same record gives the same bytes.
Json to_json(const RunRecord& record);
/// metrics.json without the scores, "final", "causal" and "covariance", which are most of it.
Json to_json_without_scores(const RunRecord& record);
Json to_json(const RunStatus& status);

/// A record from the contents of metrics.json; keys that are not known are passed over, `place` begins messages. What
/// is written again has the same bytes. Throws InputError for a key that is missing or of a wrong type, naming it:
/// experiment, label, final and causal must be there, the others may be missing or null.
RunRecord read_record(const Json& metrics, const std::string& place);

/// A run's folder: its metrics.json, and the settings in its config.json. Throws InputError, likewise for a file that
/// is missing or no JSON.
RunRecord read_record(const std::string& folder);

}  // namespace evbench
