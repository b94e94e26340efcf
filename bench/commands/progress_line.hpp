#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <string>

namespace evbench {

/// How often progress is printed.
struct ProgressPace {
  bool rewritten = false;                        ///< one line that is overwritten; else a new line each time
  std::chrono::milliseconds first{0}, every{0};  ///< first line after the beginning; interval of the others
  bool silent = false;
};

/// On a terminal one line that is overwritten; in a log a line every 10 s, so that short work prints none; with
/// `watch` a line every second.
inline ProgressPace progress_pace(bool terminal, bool quiet, bool watch) {
  using std::chrono::milliseconds;
  if (watch) return {false, milliseconds(0), milliseconds(1000), quiet};
  if (terminal) return {true, milliseconds(0), milliseconds(100), quiet};
  return {false, milliseconds(10000), milliseconds(10000), quiet};
}

/// Prints the progress of long work on the standard error.
class ProgressLine {
 public:
  ProgressLine(std::string title, bool quiet, bool watch = false)
      : ProgressLine(std::move(title), progress_pace(::isatty(STDERR_FILENO) != 0, quiet, watch)) {}
  ProgressLine(std::string title, const ProgressPace& pace)
      : title_(std::move(title)), pace_(pace), next_(Clock::now() + pace.first) {}
  ~ProgressLine() { clear(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// Clears the line for other text; the next update prints it again.
  void clear() {
    if (pace_.rewritten && !pace_.silent) fmt::print(stderr, "\r\033[K");
    std::fflush(stderr);
  }

  /// Prints only when a line is due, so it may be called at any rate.
  void update(const std::string& text) {
    const auto now = Clock::now();
    if (pace_.silent || now < next_) return;
    next_ = now + pace_.every;
    fmt::print(stderr, "{}{}  {}{}", pace_.rewritten ? "\r\033[K" : "", title_, text, pace_.rewritten ? "" : "\n");
    std::fflush(stderr);
  }

 private:
  using Clock = std::chrono::steady_clock;

  std::string title_;
  ProgressPace pace_;
  Clock::time_point next_;
};

}  // namespace evbench
