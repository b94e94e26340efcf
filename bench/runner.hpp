#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/job.hpp"
#include "bench/pipeline/pipeline.hpp"
#include "core/support/json.hpp"

namespace evbench {

/// Outcome of a job.
struct Execution {
  RunResult result;
  /// False: it ended with an error; the result then has only the status `failed` with the reason.
  bool complete = true;
  Json track_scores = {};  ///< of score_tracks(), where the source knows the truth
};

/// Executes a job: makes front-end and back-end and runs them (bench/pipeline/pipeline.hpp). `source` is the job's. An
/// exception of a plugin while it runs makes the run failed and is not thrown. Throws InputError if the front-end or
/// back-end can't be made with its options and files, before any work, and Interrupted.
///
/// All runs are executed by this function, in whatever process.
Execution execute(const Job& job, const Source& source, const Plugins& plugins, const Progress& progress,
                  bool keep_tracks = false);

/// The same with the recorded batches of record_front_end(), of a job that differs only in the back-end. The results
/// are identical.
Execution execute(const Job& job, const Source& source, const Plugins& plugins, BatchStream& batches);

/// Records all batches of the job's front-end for RecordedBatches; none if the front-end uses feedback and so depends
/// on the back-end. Throws what the front-end throws.
std::optional<std::string> record_front_end(const Job& job, const Source& source, const Plugins& plugins);

/// Throws InputError if execute() would do so before any work. Starts no commands; returns messages about parts that
/// could therefore not be checked.
std::vector<std::string> check_job(const Job& job, const Source& source, const Plugins& plugins);

/// The commands that the job's plugins start, as shell text. Throws InputError for an invalid command, and for any
/// command with --no-external.
std::vector<std::string> commands_of(const Job& job, const Plugins& plugins);

}  // namespace evbench
