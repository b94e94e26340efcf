#include "bench/sweep/process_tree.hpp"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace evbench {
namespace {

void add_descendants(pid_t process, std::vector<pid_t>& found) {
  std::error_code error;
  const auto threads = std::filesystem::directory_iterator(fmt::format("/proc/{}/task", process), error);
  if (error) return;
  for (auto thread = threads; thread != std::filesystem::directory_iterator(); thread.increment(error)) {
    std::ifstream children(thread->path() / "children");
    for (pid_t child = 0; children >> child;) {
      found.push_back(child);
      add_descendants(child, found);
    }
  }
}

double own_resident_mib(pid_t process) {
  std::ifstream file(fmt::format("/proc/{}/statm", process));
  double size = 0.0, resident = 0.0;
  file >> size >> resident;
  return resident * static_cast<double>(::sysconf(_SC_PAGESIZE)) / (1024.0 * 1024.0);
}

}  // namespace

std::vector<pid_t> descendants(pid_t process) {
  std::vector<pid_t> found;
  add_descendants(process, found);
  return found;
}

double resident_mib(pid_t process) {
  double sum = own_resident_mib(process);
  for (const pid_t child : descendants(process)) sum += own_resident_mib(child);
  return sum;
}

void kill_tree(pid_t process) {
  // Stopped processes start no others and do not lose their parents while the others are found.
  std::vector<pid_t> stopped;
  ::kill(process, SIGSTOP);
  for (std::vector<pid_t> found = descendants(process); found.size() > stopped.size(); found = descendants(process)) {
    for (const pid_t child : found) ::kill(child, SIGSTOP);
    stopped = std::move(found);
  }
  for (const pid_t child : stopped) ::kill(child, SIGKILL);
  ::kill(process, SIGKILL);
}

}  // namespace evbench
