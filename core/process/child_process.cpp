#include "core/process/child_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <ctime>
#include <memory>
#include <utility>

#include "core/support/interruption.hpp"

extern char** environ;  // NOLINT: POSIX declares it nowhere

namespace evbench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kSlice = 100;        ///< [ms] between two checks for an interruption and for a silent end
constexpr double kEndGrace = 1.0;  ///< [s] from the end of its output to that of the process

std::string reason(int error) { return std::strerror(error); }

/// Blocks SIGPIPE in this thread for its lifetime: writing to a closed pipe is an error, not a signal.
class BrokenPipeIgnored {
 public:
  BrokenPipeIgnored() {
    ::sigemptyset(&broken_pipe_);
    ::sigaddset(&broken_pipe_, SIGPIPE);
    sigset_t pending;
    ::sigemptyset(&pending);
    ::sigpending(&pending);
    was_pending_ = ::sigismember(&pending, SIGPIPE) == 1;
    ::pthread_sigmask(SIG_BLOCK, &broken_pipe_, &before_);
  }
  ~BrokenPipeIgnored() {
    const timespec at_once{0, 0};
    if (!was_pending_) {
      while (::sigtimedwait(&broken_pipe_, nullptr, &at_once) < 0 && errno == EINTR) {
      }
    }
    ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  BrokenPipeIgnored(const BrokenPipeIgnored&) = delete;
  BrokenPipeIgnored& operator=(const BrokenPipeIgnored&) = delete;

 private:
  sigset_t broken_pipe_{}, before_{};
  bool was_pending_ = false;
};

/// Reads the available bytes. False at the stream's end.
template <class Take>
bool read_some(int descriptor, Take take) {
  std::array<char, 65536> bytes;
  // Bounded: a process that writes without end must not block this loop.
  for (int i = 0; i < 16; ++i) {
    const ssize_t count = ::read(descriptor, bytes.data(), bytes.size());
    if (count == 0) return false;
    if (count < 0) return errno == EAGAIN || errno == EINTR;
    take(std::string_view(bytes.data(), static_cast<std::size_t>(count)));
  }
  return true;
}

std::string how_it_ended(int status) {
  const auto signal = [](int number) { return fmt::format("signal {} ({})", number, ::strsignal(number)); };
  if (WIFSIGNALED(status)) return "was ended by " + signal(WTERMSIG(status));
  const int code = WEXITSTATUS(status);
  if (code == 127) return "ended with exit code 127 (a shell's code for: there is no such command)";
  if (code > 128 && code < 128 + 32) {
    return fmt::format("ended with exit code {} (a shell's code for {})", code, signal(code - 128));
  }
  return fmt::format("ended with exit code {}", code);
}

}  // namespace

void ChildProcess::Descriptor::close() noexcept {
  if (number_ >= 0) ::close(number_);
  number_ = -1;
}

void ChildProcess::Descriptor::take(int number) {
  close();
  number_ = ::fcntl(number, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
  const int error = errno;
  ::close(number);
  if (number_ < 0) throw ProcessError("can't be given a pipe: " + reason(error));
}

void ChildProcess::make_pipe(Descriptor& read_end, Descriptor& write_end) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) throw ProcessError("can't be given a pipe: " + reason(errno));
  try {
    read_end.take(ends[0]);
  } catch (const ProcessError&) {
    ::close(ends[1]);
    throw;
  }
  write_end.take(ends[1]);
}

ChildProcess::ChildProcess(const std::vector<std::string>& words, const std::string& folder) {
  Descriptor theirs[3];
  make_pipe(theirs[0], input_);
  make_pipe(output_, theirs[1]);
  make_pipe(error_, theirs[2]);
  for (const Descriptor* ours : {&input_, &output_, &error_}) {
    ::fcntl(ours->number(), F_SETFL, ::fcntl(ours->number(), F_GETFL) | O_NONBLOCK);
  }
  spawn(words, folder, theirs);
}

void ChildProcess::spawn(const std::vector<std::string>& words, const std::string& folder,
                         const Descriptor (&ends)[3]) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);

  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  for (int i = 0; i < 3; ++i) ::posix_spawn_file_actions_adddup2(&actions, ends[i].number(), i);
  ::posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);
  ::posix_spawn_file_actions_addchdir_np(&actions, folder.empty() ? "." : folder.c_str());

  posix_spawnattr_t attributes;
  ::posix_spawnattr_init(&attributes);
  sigset_t none, broken_pipe;
  ::sigemptyset(&none);
  ::sigemptyset(&broken_pipe);
  ::sigaddset(&broken_pipe, SIGPIPE);
  ::posix_spawnattr_setpgroup(&attributes, 0);
  ::posix_spawnattr_setsigmask(&attributes, &none);
  ::posix_spawnattr_setsigdefault(&attributes, &broken_pipe);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);

  const int error = ::posix_spawnp(&id_, arguments.front(), &actions, &attributes, arguments.data(), environ);
  ::posix_spawnattr_destroy(&attributes);
  ::posix_spawn_file_actions_destroy(&actions);
  if (error == 0) return;
  id_ = -1;
  if (::access(folder.empty() ? "." : folder.c_str(), X_OK) != 0) {
    throw ProcessError(fmt::format("can't be started in the folder {}: {}", folder, reason(errno)));
  }
  throw ProcessError(error == ENOENT ? "can't be started: there is no such command"
                                     : "can't be started: " + reason(error));
}

ChildProcess::~ChildProcess() { kill(); }

void ChildProcess::kill() noexcept {
  if (id_ < 0) return;
  // It is not reaped yet, so its id still names its group.
  ::kill(-id_, SIGKILL);
  while (::waitpid(id_, nullptr, 0) < 0 && errno == EINTR) {
  }
  id_ = -1;
  ended_ = true;
  input_.close();
  output_.close();
  error_.close();
}

bool ChildProcess::has_ended() {
  if (ended_ || id_ < 0) return true;
  siginfo_t info{};
  if (::waitid(P_PID, static_cast<id_t>(id_), &info, WEXITED | WNOHANG | WNOWAIT) != 0 || info.si_pid != id_) {
    return false;
  }
  ended_ = true;
  status_ = info.si_code == CLD_EXITED ? (info.si_status & 0xff) << 8 : info.si_status;
  return true;
}

void ChildProcess::write_some(std::string_view& unsent) {
  const BrokenPipeIgnored guard;
  const ssize_t count = ::write(input_.number(), unsent.data(), unsent.size());
  if (count >= 0) {
    unsent.remove_prefix(static_cast<std::size_t>(count));
  } else if (errno != EAGAIN && errno != EINTR) {
    input_.close();
  }
}

void ChildProcess::read_answer() {
  if (!read_some(output_.number(), [&](std::string_view part) { received_ += part; })) output_.close();
}

void ChildProcess::read_errors() {
  if (!read_some(error_.number(), [&](std::string_view part) { errors_.add(part); })) error_.close();
}

/// Waits until one of the pipes can be served, and serves it.
void ChildProcess::serve(std::string_view& unsent, int milliseconds) {
  // poll() ignores negative descriptors: closed ones, and the input when there is nothing to write.
  pollfd pipes[3] = {
      {output_.number(), POLLIN, 0}, {error_.number(), POLLIN, 0}, {unsent.empty() ? -1 : input_.number(), POLLOUT, 0}};
  if (::poll(pipes, std::size(pipes), milliseconds) <= 0) return;
  if (pipes[0].revents != 0) read_answer();
  if (pipes[1].revents != 0) read_errors();
  if (pipes[2].revents != 0) write_some(unsent);
}

std::optional<std::string> ChildProcess::take_line(std::size_t longest) {
  const std::size_t end = received_.find('\n', searched_);
  searched_ = std::min(end, received_.size());
  if (searched_ > longest) {
    throw ProcessError(
        fmt::format("wrote a line of more than {} bytes, which begins with: {}", longest, printable(received_, 100)));
  }
  if (end == std::string::npos) return std::nullopt;
  std::string line = received_.substr(0, end);
  received_.erase(0, end + 1);
  searched_ = 0;
  return line;
}

void ChildProcess::fail_ended(const char* otherwise) {
  // Further output is read when the process ends.
  std::string_view nothing;
  const auto deadline = Clock::now() + std::chrono::duration<double>(kEndGrace);
  while (!has_ended() && Clock::now() < deadline) {
    check_interruption();
    serve(nothing, 10);
    received_.clear();
    if (!output_.is_open() && !error_.is_open()) ::poll(nullptr, 0, 5);
  }
  if (error_.is_open()) read_errors();
  throw ProcessError(has_ended() ? how_it_ended(status_) : otherwise);
}

std::string ChildProcess::exchange(std::string_view line, double timeout, std::size_t longest) {
  std::string_view unsent = line;
  if (output_.is_open()) read_answer();
  if (!received_.empty()) {
    throw ProcessError("wrote to its standard output before it was asked: " + printable(received_, 200));
  }
  const auto deadline = Clock::now() + std::chrono::duration<double>(timeout);
  while (true) {
    if (std::optional<std::string> answer = take_line(longest)) {
      if (unsent.empty()) return *std::move(answer);
      throw ProcessError("answered before it had read its message: " + printable(*answer, 200));
    }
    if (!output_.is_open()) fail_ended("closed its standard output");
    if (!input_.is_open()) fail_ended("closed its standard input");
    check_interruption();
    const std::chrono::duration<double> left = deadline - Clock::now();
    if (left.count() <= 0.0) {
      throw ProcessError(fmt::format("did not answer within {} s (is each of its lines flushed?)", timeout));
    }
    const std::size_t before = received_.size();
    // Its end does not close its output if a process that it started shares it.
    const bool over = has_ended();
    serve(unsent, over ? 0 : static_cast<int>(std::min(1e3 * left.count() + 1.0, static_cast<double>(kSlice))));
    if (over && received_.size() == before) fail_ended("ended");
  }
}

void ChildProcess::close(double grace) noexcept {
  input_.close();
  const auto deadline = Clock::now() + std::chrono::duration<double>(grace);
  std::string_view nothing;
  while (id_ >= 0 && !has_ended() && Clock::now() < deadline && !Interruption::is_requested()) {
    try {
      if (output_.is_open() || error_.is_open()) {
        serve(nothing, 5);
      } else {
        ::poll(nullptr, 0, 5);
      }
      received_.clear();
    } catch (const std::bad_alloc&) {
      break;
    }
  }
  kill();
}

}  // namespace evbench
