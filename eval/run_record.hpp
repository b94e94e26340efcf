#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/plugin/options.hpp"
#include "core/plugin/status.hpp"
#include "eval/association.hpp"
#include "eval/run_settings.hpp"

namespace evbench {

/// A part of the estimate in one world frame and scale.
struct RunPiece {
  double from = 0.0, to = 0.0;  ///< [s]
  std::size_t poses = 0, landmarks = 0;
};

/// How a run went: status.json, and the key "status" of metrics.json.
struct RunStatus {
  Status status;
  std::vector<TimeRange> still;  ///< spans in which the camera stood still
  std::vector<RunPiece> pieces;  ///< in time order; none when there is no estimate
  std::size_t scored = 0;        ///< the number of the piece that is scored, from 1; 0: none
  /// False: the run broke off (a plugin threw an exception). It is done again when it is asked for again.
  bool complete = true;
};

/// Where the time of a run went [s], wall clock.
struct RecordedTimes {
  double source = 0.0;    ///< the front-end's waiting for events
  double frontend = 0.0;  ///< making observations
  double backend = 0.0;   ///< estimating
  double waiting = 0.0;   ///< the back-end's thread, for the front-end's
  double harness = 0.0;   ///< the rest: exchanges, undistortion, hashing, sampling
  double total = 0.0;     ///< from the first exchange to the last estimate
};

/// What is known of a run that was done: metrics.json (metrics.md) and where it was found. `evbench eval` fills in the
/// scores alone; what it doesn't know is empty, and null in the file.
struct RunRecord {
  std::string experiment;  ///< runs of one experiment are compared with one another
  std::string label;       ///< the run's name within it
  std::optional<std::uint64_t> seed;
  std::string key;                        ///< of the job: runs of one key have the same trajectory; empty: not known
  std::optional<std::uint64_t> position;  ///< in its config's list of back-ends, from 0; none: it had no list
  std::string folder;                     ///< where it lies; not in the file
  RunSettings settings;                   ///< of its config.json, where there is one; not in the file
  Json final_scores, online_scores;       ///< as to_json(Scores) gives them; null: none
  Json covariance;                        ///< {kind: as to_json(CovarianceScores) gives it}; null: none
  Json common_scores;                     ///< over the time that all runs of a table cover; not in the file
  std::string final_unscored, online_unscored;  ///< why there are no scores
  std::optional<TimeRange> range;               ///< [s] of the sequence that was run: nothing outside is scored
  std::optional<double> runtime_s;              ///< processing time: front-end and back-end
  std::optional<double> data_s;                 ///< time of the sequence that was given
  std::optional<double> realtime_factor;        ///< data_s / runtime_s
  std::optional<RecordedTimes> times;
  std::optional<double> peak_rss_mib;
  std::optional<RunStatus> status;

  /// Is it measured against others? Lost and failed runs aren't.
  bool competes() const { return !status || status->status.state < RunState::lost; }
};

/// The contents of metrics.json and of status.json. The same record gives the same bytes.
Json to_json(const RunRecord& record);
Json to_json(const RunStatus& status);

/// A record from the contents of metrics.json; keys that are not known are passed over, `place` begins messages. What
/// is written again has the same bytes. Throws InputError for a key that is missing or of a wrong type, naming it:
/// experiment, label, final and online must be there, the others may be missing or null.
RunRecord read_record(const Json& metrics, const std::string& place);

/// A run's folder: its metrics.json, and the settings in its config.json. Throws InputError, likewise for a file that
/// is missing or no JSON.
RunRecord read_record(const std::string& folder);

/// The runs in these folders and in all folders below them, each once, by experiment, then in the order of their
/// config, then by label (numbers in names compare as numbers: 25 ms before 100 ms), settings, seed, folder. Runs that
/// are not complete (NAME.evbench.part) and replaced ones (NAME.evbench.old) are passed over. Throws InputError for a
/// path that is no folder, for a folder without any run, and for a metrics.json that is damaged, with the place.
/// `unreadable` gets a sentence for each run that can't be read, or whose metrics are missing; nullptr: such a one is
/// an InputError.
std::vector<RunRecord> find_runs(std::span<const std::string> folders, std::vector<std::string>* unreadable = nullptr);

/// Does name `a` come before `b`? Digits compare by value, other characters as they are.
bool natural_less(const std::string& a, const std::string& b);

}  // namespace evbench
