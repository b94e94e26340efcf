#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <functional>
#include <list>
#include <string>
#include <vector>

#include "bench/sweep/run_limits.hpp"

namespace evbench {

/// Keeps OpenCV from making threads, here and in the processes of a pool: one that is forked would wait for ever for
/// those that did not come along. To be called before anything is made of what a config names.
void stay_without_threads();

/// How a process of a pool ended.
struct Ending {
  std::size_t id = 0;            ///< that start() was given
  std::string report;            ///< what the work returned; empty: it did not come to its end
  std::string reason;            ///< then, why: "timeout after 60 s", "killed: 4.1 GiB", "killed by SIGSEGV"
  bool from_outside = false;     ///< it was killed, and not by this pool
  std::vector<std::string> log;  ///< the last lines that it and what it started wrote on standard output and error
  double seconds = 0.0;          ///< that it took
};

/// Processes that each do a piece of work and tell the result, forked from this program as it is: they have all that
/// is loaded, and begin at once. Whatever one does (crashes, hangs, takes all memory, leaves processes behind) harms no
/// other: it is held to its limits, and ends with all that it has started. They end with this program, however that
/// ends. The program must have no threads that hold locks when it starts one, and no other child processes. There is
/// one pool at a time.
class ProcessPool {
 public:
  ProcessPool();
  ~ProcessPool();  ///< kills what still runs
  ProcessPool(const ProcessPool&) = delete;
  ProcessPool& operator=(const ProcessPool&) = delete;

  /// Starts a process that does `work`. An exception that it throws ends the process, its message being in the log.
  /// Throws InputError where the system has no more processes to give.
  void start(std::size_t id, const std::function<std::string()>& work, const RunLimits& limits);

  /// Waits until a process has ended, for `most` at most, or until a signal comes.
  std::vector<Ending> wait(std::chrono::milliseconds most);

  std::size_t size() const { return processes_.size(); }

 private:
  class Process;

  void kill_orphans();

  std::list<Process> processes_;
};

}  // namespace evbench
