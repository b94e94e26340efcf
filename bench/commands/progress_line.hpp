#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <string>

namespace evbench {

/// How far long work is, on the standard error: one line that rewrites itself, on a terminal only; or, for who wants to
/// watch from anywhere, a new line each second.
class ProgressLine {
 public:
  ProgressLine(std::string title, bool quiet, bool watch = false)
      : title_(std::move(title)), rewritten_(!watch && !quiet && ::isatty(STDERR_FILENO) != 0), watched_(watch) {}
  ~ProgressLine() { clear(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// Makes room for other text; the next update shows the line again.
  void clear() {
    if (rewritten_) fmt::print(stderr, "\r\033[K");
    std::fflush(stderr);
  }

  /// May be called as often as one likes: shown ten times a second at most, once where it is watched.
  void update(const std::string& text) {
    const auto now = std::chrono::steady_clock::now();
    if (!(rewritten_ || watched_) || now - last_ < std::chrono::milliseconds(watched_ ? 1000 : 100)) return;
    last_ = now;
    fmt::print(stderr, "{}{}  {}{}", rewritten_ ? "\r\033[K" : "", title_, text, rewritten_ ? "" : "\n");
    std::fflush(stderr);
  }

 private:
  std::string title_;
  bool rewritten_, watched_;
  std::chrono::steady_clock::time_point last_ = {};
};

}  // namespace evbench
