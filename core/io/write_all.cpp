#include "core/io/write_all.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "core/support/error.hpp"

namespace evbench {

int write_all(int file, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    if (written < 0 && errno != EINTR) return errno;
    if (written > 0) bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return 0;
}

void fail_to_write(const std::string& path, int error) {
  throw OutputError(fmt::format("{}: can't be written: {}", path, std::strerror(error)));
}

}  // namespace evbench
