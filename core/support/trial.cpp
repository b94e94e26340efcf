#include "core/support/trial.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>

#include "core/support/interruption.hpp"

namespace evbench {
namespace {

constexpr int kCrashes[] = {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGXCPU};

/// The copy dies without a word, a core file or the handlers of this process.
void prepare(unsigned most_seconds) {
  for (const int crash : kCrashes) ::signal(crash, SIG_DFL);
  ::signal(SIGALRM, SIG_DFL);
  ::alarm(10 * most_seconds);
  const rlimit no_core{0, 0}, processor{most_seconds, most_seconds + 1};
  ::setrlimit(RLIMIT_CORE, &no_core);
  ::setrlimit(RLIMIT_CPU, &processor);
  const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  ::dup2(nowhere, STDOUT_FILENO);
  ::dup2(nowhere, STDERR_FILENO);
}

}  // namespace

std::string trial(const std::function<void()>& work, unsigned most_seconds) {
  const pid_t copy = ::fork();
  if (copy < 0) return "";
  if (copy == 0) {
    prepare(most_seconds);
    try {
      work();
    } catch (const std::exception&) {
    }
    ::_exit(0);
  }
  int status = 0;
  while (::waitpid(copy, &status, 0) < 0) {
    if (errno != EINTR) return "";
    if (Interruption::is_requested()) ::kill(copy, SIGKILL);
  }
  check_interruption();
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM) return "Time limit exceeded";
  for (const int crash : kCrashes) {
    if (WIFSIGNALED(status) && WTERMSIG(status) == crash) return ::strsignal(crash);
  }
  // A sanitizer ends a process with a status.
  return WIFEXITED(status) && WEXITSTATUS(status) != 0 ? "a sanitizer's report" : "";
}

}  // namespace evbench
