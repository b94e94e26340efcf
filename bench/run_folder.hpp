#pragma once

#include <optional>
#include <string>

#include "bench/experiment.hpp"
#include "bench/runner.hpp"
#include "core/io/atomic_file.hpp"
#include "eval/run_record.hpp"

namespace evbench {

/// Removes the folders of a path that it did not find and that are empty at its end.
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
///   config.json      resolved, complete: can be run again from anywhere
///   job.json         what determines the trajectory: its SHA-256 begins with the key's digits
///   manifest.json    program, host, when the run was done, seed, SHA-256 of config.json, of each input and of the
///                    tracks; how long the files are that stay as they are
///   final.tum, causal.tum, map.ply   the estimate: after the fact, causal, landmarks
///   causal_poses.txt         every pose told while the data came in, with the time at which it was known
///   covariance.txt   relative poses with the covariances that the back-end gave, where it has them
///   groundtruth.tum  the source's, in the time range of the run (and 1 s around it), where there is one
///   metrics.json, status.json        docs/reference/metrics.md
///   timing.csv       a line an update
///   tracks.txt, track_ends.txt       what the front-end told, raw pixels, where it was asked for
///   estimated_parameters.csv       what the back-end has learnt of its parameters by then, where it does
///   log.txt
///
/// Where the estimate is in segments, these are of the longest one; the others are final.segment2.tum, causal.segment2.tum,
/// and so on, numbered in time order from 1 (status.json lists all). The folder appears complete or not at all; an
/// older run of the same key is replaced.
class RunFolder {
 public:
  /// Takes the folder: throws OutputError when it can't be made and FolderTaken when another run is writing to it,
  /// before any work.
  RunFolder(const std::string& out, const std::string& experiment, const std::string& key);

  /// Writes a run, scored by its config. `ground_truth` is what ground_truth_tum() gives. With `problem`, also
  /// problem.txt, the estimation problem that the run ended with, where the back-end has one. Tracks that were kept are
  /// tracks.txt and track_ends.txt.
  RunRecord write(const RunConfig& config, const JobIdentity& identity, const Source& source,
                  const std::string& ground_truth, const Execution& execution, bool problem = false);

  /// Writes a run that ended without telling anything, in place of what has been written of it: failed for this reason,
  /// not complete. `log`: what is known of how it ended.
  RunRecord write_broken_off(const RunConfig& config, const JobIdentity& identity, const std::string& reason,
                             const std::vector<std::string>& log);

  const std::string& path() const { return path_; }

 private:
  void write_files(const RunConfig& config, const JobIdentity& identity, const RunResult& result) const;
  RunRecord finish(const RunConfig& config, const JobIdentity& identity, const Execution& execution, RunRecord record);

  std::string path_;
  EmptyFolders made_;  // before the folder: it must be gone by then
  AtomicFolder folder_;
};

/// The text of groundtruth.tum; empty where there is no ground truth.
std::string ground_truth_tum(const Source& source);

/// What lies in a run's folder.
enum class RunCondition {
  absent,
  complete,
  broken_off,  ///< the run's failure: it did not come to its end
  damaged,     ///< files are missing, not as long as they were, or can't be read
};

/// What lies in a folder of the job with this key. `why`: of a run that broke off its reason, of a damaged one what is
/// wrong.
RunCondition condition_of(const std::string& folder, const std::string& key, std::string& why);

/// Where a complete run of this job lies below `out`: of this experiment or, where there is none, of another one.
std::optional<std::string> find_complete_run(const std::string& out, const std::string& experiment,
                                             const JobIdentity& identity);

/// Makes a run that lies in the folder `from` one of this config in `to`, which may be the same folder: copied, renamed
/// and scored again, as far as that is needed. Both have the same job.
RunRecord adopt_run(const std::string& from, const std::string& to, const RunConfig& config);

/// The protocol that a run was scored by: of its config.json, with overrides "evaluation.KEY=VALUE". Throws InputError
/// when it has none.
ScoreOptions protocol_of_run(const std::string& folder, const std::vector<std::string>& overrides = {});

/// Throws InputError where the run has scores, but would have none by this protocol, though there is ground truth.
void require_scores(const std::string& folder, const ScoreOptions& options);

/// Scores a run's folder again by this protocol, and rewrites metrics.json, and config.json where it is another one.
RunRecord score_again(const std::string& folder, const ScoreOptions& options);

}  // namespace evbench
