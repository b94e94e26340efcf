#include "core/io/spool.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "core/io/open_to_read.hpp"
#include "core/io/temporary_file.hpp"
#include "core/support/interruption.hpp"

namespace evbench {
namespace {

[[noreturn]] void fail(const std::string& path, int error) {
  check_interruption();  // opening may have waited
  throw InputError(fmt::format("{}: can't be read: {}", path, std::strerror(error)));
}

std::unique_ptr<TemporaryFile> copy(const std::string& path) {
  const int file = open_to_read(path);
  if (file < 0) fail(path, errno);
  const auto close = [](const int* open) { ::close(*open); };
  const std::unique_ptr<const int, decltype(close)> closed(&file, close);
  auto copy = std::make_unique<TemporaryFile>();
  std::vector<std::byte> block(1 << 20);
  while (true) {
    check_interruption();
    const ssize_t got = ::read(file, block.data(), block.size());
    if (got < 0) fail(path, errno);
    if (got == 0) return copy;
    copy->write(std::span(block).first(static_cast<std::size_t>(got)));
  }
}

}  // namespace

std::string seekable_path(const std::string& path) {
  struct stat status {};
  if (path != "-" && (::stat(path.c_str(), &status) != 0 || S_ISREG(status.st_mode) || S_ISDIR(status.st_mode))) {
    return path;
  }
  static std::mutex mutex;
  static std::map<std::string, std::unique_ptr<TemporaryFile>> copies;  // a pipe can be read only once
  const std::lock_guard lock(mutex);
  std::unique_ptr<TemporaryFile>& kept = copies[path];
  if (!kept) kept = copy(path);
  return kept->path();
}

}  // namespace evbench
