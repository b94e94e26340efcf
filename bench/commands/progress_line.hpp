#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <string>

namespace evbench {

/// One line that rewrites itself, on a terminal only.
class ProgressLine {
 public:
  ProgressLine(std::string title, bool quiet)
      : title_(std::move(title)), shown_(!quiet && ::isatty(STDERR_FILENO) != 0) {}
  ~ProgressLine() { clear(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// Makes room for other text; the next update shows the line again.
  void clear() {
    if (shown_) fmt::print(stderr, "\r\033[K");
    std::fflush(stderr);
  }

  /// At most ten times a second, so that it may be called as often as one likes.
  void update(const std::string& text) {
    const auto now = std::chrono::steady_clock::now();
    if (!shown_ || now - last_ < std::chrono::milliseconds(100)) return;
    last_ = now;
    fmt::print(stderr, "\r\033[K{}  {}", title_, text);
    std::fflush(stderr);
  }

 private:
  std::string title_;
  bool shown_;
  std::chrono::steady_clock::time_point last_ = {};
};

}  // namespace evbench
