#pragma once

#include <optional>
#include <string>

#include "bench/experiment.hpp"
#include "bench/runner.hpp"
#include "core/io/atomic_file.hpp"
#include "eval/run_record.hpp"

namespace evbench {

/// Removes the folders of a path that did not exist at construction and are empty at destruction.
class EmptyFolders {
 public:
  explicit EmptyFolders(const std::string& path);
  ~EmptyFolders();
  EmptyFolders(const EmptyFolders&) = delete;
  EmptyFolders& operator=(const EmptyFolders&) = delete;

 private:
  std::vector<std::string> made_;  ///< the innermost first
};

/// A run's folder, OUT/EXPERIMENT/KEY:
///
///   config.json      complete, with defaults: can be run from any folder
///   job.json         all that determines the trajectory: its SHA-256 begins with the key's digits
///   manifest.json    program, host, time of completion, seed, SHA-256 of config.json, of each input and of the tracks;
///                    sizes of the files that do not change
///   final.tum, causal.tum, map.ply   the final (smoothed) and the causal trajectory, the landmarks
///   velocities.txt                   body velocities at the poses of final.tum, if the back-end has them
///   causal_poses.txt                 all published poses, with the times at which they were known
///   covariance.txt   relative poses with covariances, if the back-end has them
///   groundtruth.tum  ground truth in the time range of the run and 1 s around it, if the source has it
///   metrics.json, status.json        docs/reference/metrics.md
///   timing.csv       a line per update
///   tracks.txt, track_ends.txt       the front-end's tracks, raw pixels, if requested
///   estimated_parameters.csv         parameters that the back-end has estimated by each update, if it does
///   log.txt
///
/// If the trajectory has several segments, these files are of the longest one. Those of the others are named
/// final.segment2.tum, causal.segment2.tum, ..., numbered in time order from 1 (status.json lists all). The folder
/// appears complete or not at all; an older run of the same key is replaced.
class RunFolder {
 public:
  /// Locks the folder before any work. Throws OutputError if it can't be made and FolderTaken if another run is writing
  /// to it.
  RunFolder(const std::string& out, const std::string& experiment, const std::string& key);

  /// Writes a run, scored by its config. `ground_truth`: of ground_truth_tum(). With `problem` also problem.txt, the
  /// final estimation problem, if the back-end has one. Kept tracks are written to tracks.txt and track_ends.txt.
  RunRecord write(const RunConfig& config, const JobIdentity& identity, const Source& source,
                  const std::string& ground_truth, const Execution& execution, bool problem = false);

  /// Writes a run that ended without a result, e.g. a crashed process: failed for this reason, not complete. Replaces
  /// files written so far. `log`: lines about its end.
  RunRecord write_broken_off(const RunConfig& config, const JobIdentity& identity, const std::string& reason,
                             const std::vector<std::string>& log);

  const std::string& path() const { return path_; }

 private:
  void write_files(const RunConfig& config, const JobIdentity& identity, const RunResult& result) const;
  RunRecord finish(const RunConfig& config, const JobIdentity& identity, const Execution& execution, RunRecord record);

  std::string path_;
  EmptyFolders made_;  // declared before folder_, which must be destroyed first
  AtomicFolder folder_;
};

/// The text of groundtruth.tum; empty if there is no ground truth.
std::string ground_truth_tum(const Source& source);

/// Condition of a run's folder.
enum class RunCondition {
  absent,
  complete,
  broken_off,  ///< the run ended with an error before its end
  damaged,     ///< files are missing, have another size, or can't be read
};

/// Condition of the folder of the job with this key. `why` gets the reason if the run is broken off or damaged.
RunCondition condition_of(const std::string& folder, const std::string& key, std::string& why);

/// Finds the folder of a complete run of this job below `out`: of this experiment, else of another one.
std::optional<std::string> find_complete_run(const std::string& out, const std::string& experiment,
                                             const JobIdentity& identity);

/// Reuses the run in the folder `from` as a run of this config in `to`, which may be the same folder: copies, relabels
/// and scores it again as needed. Both have the same job.
RunRecord adopt_run(const std::string& from, const std::string& to, const RunConfig& config);

/// The evaluation protocol of a run, from its config.json, with overrides "evaluation.KEY=VALUE". Throws InputError if
/// it has none.
ScoreOptions protocol_of_run(const std::string& folder, const std::vector<std::string>& overrides = {});

/// Throws InputError if the run has scores and ground truth, but would have no scores by this protocol.
void require_scores(const std::string& folder, const ScoreOptions& options);

/// Scores a run's folder again by this protocol, and rewrites metrics.json, and config.json if the protocol changed.
RunRecord score_again(const std::string& folder, const ScoreOptions& options);

}  // namespace evbench
