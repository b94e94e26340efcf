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

/// Keeps OpenCV from making threads, here and in the processes of a pool: a forked process would wait for ever for
/// threads that it does not have. Call it before anything that a config names is made.
void stay_without_threads();

/// How a process of a pool ended.
struct Ending {
  std::size_t id = 0;            ///< that start() was given
  std::string report;            ///< return value of the work; empty: it did not finish
  std::string reason;            ///< why, then: "timeout after 60 s", "killed: 4.1 GiB", "killed by SIGSEGV"
  bool from_outside = false;     ///< it was killed, but not by this pool
  std::vector<std::string> log;  ///< last lines of its and its children's standard output and error
  double seconds = 0.0;          ///< duration
};

/// Processes that each do a piece of work and return the result. They are forked from this program, so that they have
/// everything loaded and begin at once. A process that crashes, hangs, takes all memory or leaves processes behind does
/// not affect the others: its limits are enforced, and it ends with all processes that it has started. All of them end
/// with this program, however it ends. When a process is started, the program must have no threads that hold locks, and
/// no other child processes. Only one pool may exist at a time.
class ProcessPool {
 public:
  ProcessPool();
  ~ProcessPool();  ///< kills what still runs
  ProcessPool(const ProcessPool&) = delete;
  ProcessPool& operator=(const ProcessPool&) = delete;

  /// Starts a process that does `work`. An exception that it throws ends the process, its message being in the log.
  /// Throws InputError where the system cannot start another process.
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
