#pragma once

#include <string>
#include <vector>

#include "bench/sweep/local_executor.hpp"
#include "eval/sweep_record.hpp"

namespace evbench {

/// Progress of a sweep's folder, whichever processes work on it: each run of its sweep.json once.
struct SweepStatus {
  std::string folder, name;
  std::size_t runs = 0, done = 0, failed = 0, running = 0, missing = 0;
  std::size_t others = 0;             ///< runs in its folder that are not in its plan (any more); tables skip them
  std::vector<TroubledRun> troubled;  ///< failed (including damaged) or lost ones
};

/// The sweeps in a folder: its own or those of the folders in it. Throws InputError where there is none, and for a
/// sweep.json that can't be read.
std::vector<SweepStatus> read_sweep_status(const std::string& folder);

/// The line that reports `others`.
std::string describe_others(std::size_t others);

/// SweepStatus::others of a sweep's folder.
std::size_t count_others(const std::string& folder, const SweepRecord& sweep);

}  // namespace evbench
