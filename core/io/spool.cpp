#include "core/io/spool.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <map>
#include <mutex>
#include <span>
#include <vector>

#include "core/io/write_all.hpp"
#include "core/support/error.hpp"
#include "core/support/interruption.hpp"

namespace evbench {
namespace {

/// Everything that `from` gives, into `to`.
void copy_all(int from, int to, const std::string& path) {
  std::vector<std::byte> piece(1 << 20);
  while (true) {
    check_interruption();
    const ssize_t got = ::read(from, piece.data(), piece.size());
    if (got == 0) return;
    if (got < 0 && errno != EINTR) throw InputError(fmt::format("{}: can't be read: {}", path, std::strerror(errno)));
    const auto bytes = std::span(piece).first(static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    if (const int error = write_all(to, bytes); error != 0) {
      throw OutputError(fmt::format("{}: can't be copied to the disk: {}", path, std::strerror(error)));
    }
  }
}

/// The copy's path, by which other processes can open it, too.
std::string copy_to_disk(const std::string& path) {
  const int from = path == "-" ? STDIN_FILENO : ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (from < 0) {
    const int error = errno;
    check_interruption();  // it may have waited for a pipe's writer
    throw InputError(fmt::format("{}: {}", path, std::strerror(error)));
  }
  const std::string folder = std::filesystem::temp_directory_path().string();
  const int to = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (to < 0) throw OutputError(fmt::format("{}: no file can be made there: {}", folder, std::strerror(errno)));
  copy_all(from, to, path);
  if (from != STDIN_FILENO) ::close(from);
  return fmt::format("/proc/{}/fd/{}", ::getpid(), to);
}

}  // namespace

std::string seekable_path(const std::string& path) {
  struct stat status {};
  if (path != "-" && (::stat(path.c_str(), &status) != 0 || S_ISREG(status.st_mode) || S_ISDIR(status.st_mode))) {
    return path;
  }
  static std::mutex mutex;
  static std::map<std::string, std::string> copies;  // a pipe can be read once only
  const std::lock_guard lock(mutex);
  std::string& copy = copies[path];
  if (copy.empty()) copy = copy_to_disk(path);
  return copy;
}

}  // namespace evbench
