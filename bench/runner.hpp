#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/job.hpp"
#include "bench/pipeline/pipeline.hpp"

namespace evbench {

/// What became of a job.
struct Execution {
  RunResult result;
  /// False: it broke off; the result then has nothing but a status, failed, with the reason.
  bool complete = true;
};

/// Does a job: makes front-end and back-end and lets them work together (bench/pipeline/pipeline.hpp). `source` is the
/// job's. What a plugin throws while it works makes the run failed and is no error here. Throws InputError for what can
/// be told before any work, a front-end or back-end that can't be made of its options and files, and Interrupted.
///
/// The one place where runs are done, whatever process they have.
Execution execute(const Job& job, const Source& source, const Plugins& plugins, const Progress& progress,
                  bool keep_tracks = false);

/// Likewise, with what the front-end gives known beforehand, from record_front_end() of a job that differs in the
/// back-end alone: with the same result, byte by byte.
Execution execute(const Job& job, const Source& source, const Plugins& plugins, BatchStream& batches);

/// All that the job's front-end gives, as RecordedBatches reads it; nothing for one that makes use of feedback, and so
/// gives each back-end something else. Throws what the front-end throws.
std::optional<std::string> record_front_end(const Job& job, const Source& source, const Plugins& plugins);

/// Throws InputError where execute() would do so before any work. Starts no command: returns, as sentences, what could
/// therefore not be checked.
std::vector<std::string> check_job(const Job& job, const Source& source, const Plugins& plugins);

/// The commands that the job's plugins start, as one would type them. Throws InputError for what is none, and for any
/// where external code is refused.
std::vector<std::string> commands_of(const Job& job, const Plugins& plugins);

}  // namespace evbench
