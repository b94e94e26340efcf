#pragma once

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>

#include "core/support/error.hpp"

namespace evbench {

/// A pipe with a non-blocking read end.
class Pipe {
 public:
  Pipe() {
    if (::pipe2(ends_.data(), O_CLOEXEC) != 0) {
      throw InputError(fmt::format("no pipe can be had for a run: {}", std::strerror(errno)));
    }
    ::fcntl(ends_[0], F_SETFL, O_NONBLOCK);
  }
  ~Pipe() {
    close_read();
    close_write();
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  int read_end() const { return ends_[0]; }
  int write_end() const { return ends_[1]; }
  void close_read() { close(ends_[0]); }
  void close_write() { close(ends_[1]); }

  /// Reads the available data; closes the read end when there will be no more.
  template <class Take>
  void read(Take take) {
    std::array<char, 65536> bytes;
    // Not until nothing is left, as a process may write without end.
    for (int i = 0; i < 16 && ends_[0] >= 0; ++i) {
      const ssize_t count = ::read(ends_[0], bytes.data(), bytes.size());
      if (count > 0) take(std::string_view(bytes.data(), static_cast<std::size_t>(count)));
      if (count == 0) close_read();
      if (count <= 0) return;
    }
  }

 private:
  static void close(int& end) {
    if (end >= 0) ::close(end);
    end = -1;
  }

  std::array<int, 2> ends_ = {-1, -1};
};

}  // namespace evbench
