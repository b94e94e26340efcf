#pragma once

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
/// The one place where runs are done: a run that is to have a process of its own gets it here.
Execution execute(const Job& job, const Source& source, const Plugins& plugins, const Progress& progress,
                  bool keep_tracks = false);

/// Throws InputError where execute() would do so before any work.
void check_job(const Job& job, const Source& source, const Plugins& plugins);

}  // namespace evbench
