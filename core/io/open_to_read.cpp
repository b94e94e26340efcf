#include "core/io/open_to_read.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>

namespace evbench {

int open_to_read(const std::string& path) {
  constexpr int kPatience = 1000;  // [ms]
  struct stat status {};
  const bool is_input = path == "-";
  if (!is_input && (::stat(path.c_str(), &status) != 0 || !S_ISFIFO(status.st_mode))) {
    return ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  }
  const int file = is_input ? ::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 0)
                            : ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // does not wait for a writer
  if (file < 0) return -1;
  pollfd ready = {file, POLLIN, 0};
  int found = ::poll(&ready, 1, kPatience);
  if (found == 0) {
    fmt::print(stderr, "{}: nobody has written to it yet; waiting\n", is_input ? "standard input" : path);
    found = ::poll(&ready, 1, -1);
  }
  if (found < 0) {
    const int error = errno;
    ::close(file);
    errno = error;
    return -1;
  }
  if (!is_input) ::fcntl(file, F_SETFL, ::fcntl(file, F_GETFL) & ~O_NONBLOCK);
  return file;
}

}  // namespace evbench
