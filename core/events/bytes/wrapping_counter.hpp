#pragma once

#include <cstdint>

#include "core/events/bytes/fault_count.hpp"

namespace evbench {

/// Unwraps a camera's time counter. The counter has wrapped when it was near the end of its range and is near the
/// beginning: over a gap that is no longer than it has run, and no longer than a quarter of the range. Any other step
/// back by more than 0.25 s is a fault, and time steps back with it. When the counter jumps and one of the next words
/// continues from before the jump, time continues from there, too: the words between were wrong.
class WrappingCounter {
 public:
  /// `unit`: duration of a count [µs].
  WrappingCounter(int bits, std::int64_t unit)
      : range_(std::int64_t{1} << bits), near_(kNear / unit), mask_(static_cast<std::uint32_t>(range_ - 1)) {}

  /// The next word's time [units]. `place`: position of the word, for messages.
  std::int64_t update(std::uint32_t value, std::uint64_t place) {
    const std::uint32_t step = (value - static_cast<std::uint32_t>(run_.time)) & mask_;
    if (!settled_ || step > near_) return update_unusual(value, place);
    return run_.time += step;
  }

  /// Reports the faults since the last report. `unit`: what the places count.
  void report(Faults& faults, const char* unit = "byte");

 private:
  static constexpr std::int64_t kNear = 250'000;  ///< [µs]: no jump, in either direction
  static constexpr int kPendingWords = 3;

  /// A period in which the counter has not stepped back.
  struct Run {
    std::int64_t start = 0, time = 0;
  };

  std::int64_t update_unusual(std::uint32_t value, std::uint64_t place);
  void jump(std::uint32_t value, std::uint64_t place);
  std::int64_t step_from(std::int64_t time, std::uint32_t value) const;

  std::int64_t range_, near_;
  std::uint32_t mask_;
  Run run_, before_jump_;
  bool started_ = false, settled_ = false;  ///< settled: neither at the beginning nor after a jump
  int pending_words_ = 0;                   ///< that may still continue from before the jump
  std::uint64_t jump_ = 0;                  ///< position of the jump
  bool jump_is_reported_ = false;
  FaultCount steps_back_, wrong_words_;
};

}  // namespace evbench
