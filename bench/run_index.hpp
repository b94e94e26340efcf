#pragma once

#include <chrono>
#include <string>

namespace evbench {

/// Writes OUT/EXPERIMENT/index.csv: a line for each run that lies in the folder of an experiment, by label, settings
/// and seed: experiment, label, the settings in which runs of a label differ, seed, key, folder (within the
/// experiment's), errors, pairs, coverage, scale, status, reason, trajectory, protocol. The same runs give the same
/// bytes. The file is there whole at any time; of several processes that write it, the last one has seen all runs. Runs
/// that can't be read are left out; without any run the file goes. Throws InputError where it can't be written.
void write_run_index(const std::string& experiment);

/// The index of an experiment whose runs are being done. As all runs are read each time, it is written so often that
/// this takes a twentieth of the time at most, and when it is asked for.
class RunIndex {
 public:
  explicit RunIndex(std::string experiment) : experiment_(std::move(experiment)) {}

  /// A run has come: writes the index, unless it was written lately.
  void add();
  /// Writes the index where runs came since.
  void write();

 private:
  using Clock = std::chrono::steady_clock;

  std::string experiment_;
  bool outdated_ = false;
  Clock::time_point due_ = {};
};

}  // namespace evbench
