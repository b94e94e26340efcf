#pragma once

#include <string>
#include <vector>

#include "bench/sweep/local_executor.hpp"

namespace evbench {

/// How a sweep is handed to Slurm.
struct SlurmOptions {
  std::string partition;  ///< empty: the cluster's default
  std::string time;       ///< of a task, in sbatch's format (minutes, hours:minutes:seconds); empty: from the timeout
  std::string setup;      ///< a line of shell before the program, or around it: {} is the command
  int width = 0;          ///< tasks at a time; 0: as many as the cluster allows
  bool wait = false;      ///< wait until the table is made
};

/// The submitted jobs.
struct SlurmSubmission {
  std::string array_job, table_job;  ///< Slurm's job numbers
  std::size_t tasks = 0;
  std::string folder;  ///< SWEEP/slurm/N: manifest.jsonl, tasks.sh, a log a task, the table's
};

/// Submits runs as a job array, each task being `evbench task` on its lines of a manifest, and a job that waits for all
/// of them, however they end, and writes `sweep_folder`/table.md and status.txt. A task on a node that fails is run
/// again by Slurm; one that was killed leaves its run to be done, and the next sweep submits it. Runs that are
/// submitted twice are done once. Throws InputError when there is no Slurm or it refuses a job, with its message.
SlurmSubmission submit_to_slurm(const std::vector<PlannedRun>& runs, const ExecutorOptions& options,
                                const SlurmOptions& slurm, const std::string& sweep_folder);

}  // namespace evbench
