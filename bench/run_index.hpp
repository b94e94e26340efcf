#pragma once

#include <chrono>
#include <string>

namespace evbench {

/// Writes OUT/EXPERIMENT/index.csv: a line for each run in the folder of an experiment, sorted by label, settings and
/// seed. Columns: experiment, label, the settings in which runs of a label differ, seed, key, folder (within the
/// experiment's), errors, pairs, coverage, scale, status, reason, trajectory, protocol. The same runs give an identical
/// file. The file is complete at any time; if several processes write it, the last version has all runs. Unreadable
/// runs are left out; without any run the file is removed. Throws InputError if it can't be written.
void write_run_index(const std::string& experiment);

/// Keeps the index of an experiment up to date while its runs are done. Writing reads all runs, so it is limited to
/// about a twentieth of the time.
class RunIndex {
 public:
  /// It is written again if the process that did the last runs ended before it could do so.
  explicit RunIndex(std::string experiment);

  /// Call after a run was added: writes the index, unless it was written recently.
  void add();
  /// Writes the index if runs were added since the last time.
  void write();

 private:
  using Clock = std::chrono::steady_clock;

  std::string experiment_;
  bool outdated_;
  Clock::time_point due_ = {};
};

}  // namespace evbench
