#include "bench/sweep/process_pool.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <fstream>
#include <opencv2/core/utility.hpp>
#include <optional>
#include <span>
#include <sstream>

#include "bench/sweep/pipe.hpp"
#include "bench/sweep/process_tree.hpp"
#include "core/io/write_all.hpp"
#include "core/process/line_tail.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

using Clock = std::chrono::steady_clock;

/// How often limits are checked.
constexpr std::chrono::milliseconds kWatch(50);

std::string shown_memory(double mib) {
  return mib < 1024.0 ? fmt::format("{:.0f} MiB", mib) : fmt::format("{:.1f} GiB", mib / 1024.0);
}

/// Sets up a new process: it ends with its parent, is the first to be killed when memory is short, has default signal
/// handlers, and writes into the pipe.
void settle(pid_t parent, const Pipe& output) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(1);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) ::signal(signal, SIG_DFL);
  std::ofstream("/proc/self/oom_score_adj") << "500";
  ::dup2(output.write_end(), STDOUT_FILENO);
  ::dup2(output.write_end(), STDERR_FILENO);
}

}  // namespace

void stay_without_threads() { cv::setNumThreads(0); }

class ProcessPool::Process {
 public:
  Process(std::size_t id, const std::function<std::string()>& work, const RunLimits& limits)
      : id_(id), limits_(limits), begin_(Clock::now()) {
    std::fflush(nullptr);  // what is buffered would be written twice
    const pid_t parent = ::getpid();
    pid_ = ::fork();
    if (pid_ < 0) throw InputError(fmt::format("no process can be had for a run: {}", std::strerror(errno)));
    if (pid_ == 0) live(parent, work);
    descriptor_ = static_cast<int>(::syscall(SYS_pidfd_open, pid_, 0));  // glibc's header of it is C's alone
    output_.close_write();
    report_.close_write();
  }

  ~Process() {
    if (pid_ > 0) {
      kill_tree(pid_);
      while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
      }
    }
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  pid_t pid() const { return pid_; }

  void add_descriptors(std::vector<pollfd>& to) const {
    for (const int descriptor : {descriptor_, output_.read_end(), report_.read_end()}) {
      if (descriptor >= 0) to.push_back({descriptor, POLLIN, 0});
    }
  }

  /// Reads its output, enforces its limits, and returns how it ended, once it has.
  std::optional<Ending> look() {
    listen();
    int status = 0;
    if (::waitpid(pid_, &status, WNOHANG) == pid_) return ending(status);
    if (limit_.empty()) watch();
    return std::nullopt;
  }

 private:
  [[noreturn]] void live(pid_t parent, const std::function<std::string()>& work) {
    settle(parent, output_);
    int code = EXIT_FAILURE;
    try {
      const std::string report = work();
      std::fflush(nullptr);
      if (write_all(report_.write_end(), std::as_bytes(std::span(report))) == 0) code = EXIT_SUCCESS;
    } catch (const std::exception& error) {
      fmt::print(stderr, "{}\n", error.what());
      std::fflush(nullptr);
    }
    ::_exit(code);  // the program's exit handlers are the parent's
  }

  void listen() {
    output_.read([&](std::string_view text) { log_.add(text); });
    report_.read([&](std::string_view text) { told_ += text; });
  }

  void watch() {
    if (limits_.seconds > 0.0 && seconds() > limits_.seconds) {
      limit_ = fmt::format("timeout after {} s", limits_.seconds);
    } else if (limits_.memory_mib > 0.0 && Clock::now() - watched_ >= kWatch) {
      watched_ = Clock::now();
      const double mib = resident_mib(pid_);
      if (mib > limits_.memory_mib) {
        limit_ = fmt::format("killed: {}, limit {}", shown_memory(mib), shown_memory(limits_.memory_mib));
      }
    }
    if (!limit_.empty()) kill_tree(pid_);
  }

  Ending ending(int status) {
    pid_ = -1;
    listen();
    Ending ending;
    ending.id = id_;
    ending.seconds = seconds();
    std::istringstream lines(log_.text(""));
    for (std::string line; std::getline(lines, line);) {
      if (!line.empty()) ending.log.push_back(line);
    }
    if (!limit_.empty()) {
      ending.reason = limit_;
    } else if (WIFSIGNALED(status)) {
      const char* const name = ::sigabbrev_np(WTERMSIG(status));
      ending.reason = fmt::format("killed by SIG{}", name == nullptr ? std::to_string(WTERMSIG(status)) : name);
      ending.from_outside = WTERMSIG(status) == SIGKILL || WTERMSIG(status) == SIGTERM;
    } else if (WEXITSTATUS(status) != EXIT_SUCCESS || told_.empty()) {
      ending.reason = fmt::format("ended with exit code {} before it was done", WEXITSTATUS(status));
    } else {
      ending.report = told_;
    }
    return ending;
  }

  double seconds() const { return std::chrono::duration<double>(Clock::now() - begin_).count(); }

  std::size_t id_;
  RunLimits limits_;
  Clock::time_point begin_, watched_ = {};
  Pipe output_, report_;
  pid_t pid_ = -1;
  int descriptor_ = -1;
  LineTail log_;
  std::string told_, limit_;
};

ProcessPool::ProcessPool() {
  ::prctl(PR_SET_CHILD_SUBREAPER, 1);  // orphaned descendants become children of this process
}

ProcessPool::~ProcessPool() {
  processes_.clear();
  kill_orphans();
  ::prctl(PR_SET_CHILD_SUBREAPER, 0);
}

void ProcessPool::start(std::size_t id, const std::function<std::string()>& work, const RunLimits& limits) {
  processes_.emplace_back(id, work, limits);
}

std::vector<Ending> ProcessPool::wait(std::chrono::milliseconds most) {
  std::vector<pollfd> descriptors;
  for (const Process& process : processes_) process.add_descriptors(descriptors);
  ::poll(descriptors.data(), descriptors.size(), static_cast<int>(std::min(most, kWatch).count()));
  std::vector<Ending> endings;
  for (auto process = processes_.begin(); process != processes_.end();) {
    auto ending = process->look();
    if (ending) endings.push_back(std::move(*ending));
    process = ending ? processes_.erase(process) : std::next(process);
  }
  if (!endings.empty()) kill_orphans();
  return endings;
}

/// Ends children of this program that do not belong to the pool: an ended process has started them.
void ProcessPool::kill_orphans() {
  const auto is_ours = [&](pid_t child) {
    return std::ranges::find(processes_, child, &Process::pid) != processes_.end();
  };
  std::ifstream children(fmt::format("/proc/self/task/{}/children", ::gettid()));
  for (pid_t child = 0; children >> child;) {
    if (is_ours(child)) continue;
    kill_tree(child);
    ::waitpid(child, nullptr, 0);
  }
}

}  // namespace evbench
