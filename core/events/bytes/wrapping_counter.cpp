#include "core/events/bytes/wrapping_counter.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace evbench {

/// The smaller step, forwards or backwards.
std::int64_t WrappingCounter::step_from(std::int64_t time, std::uint32_t value) const {
  const std::int64_t ahead = (value - static_cast<std::uint32_t>(time)) & mask_;
  return ahead > range_ / 2 ? ahead - range_ : ahead;
}

std::int64_t WrappingCounter::update_unusual(std::uint32_t value, std::uint64_t place) {
  if (!std::exchange(started_, true)) {
    run_ = {value, value};
    settled_ = true;
    return run_.time;
  }
  const auto is_near = [&](std::int64_t step) { return std::abs(step) <= near_; };
  const std::int64_t step = step_from(run_.time, value), step_before = step_from(before_jump_.time, value);
  if (pending_words_ > 0 && is_near(step_before) &&
      !(is_near(step) && run_.time + step == before_jump_.time + step_before)) {
    if (!jump_is_reported_) wrong_words_.add(jump_);
    run_ = {before_jump_.start, before_jump_.time + step_before};
    pending_words_ = 0;
  } else if (is_near(step)) {
    run_.time += step;
    pending_words_ = std::max(pending_words_ - 1, 0);
  } else {
    jump(value, place);
  }
  settled_ = pending_words_ == 0;
  return run_.time;
}

void WrappingCounter::jump(std::uint32_t value, std::uint64_t place) {
  if (pending_words_ == 0) {
    before_jump_ = run_;
    pending_words_ = kPendingWords;
    jump_ = place;
    jump_is_reported_ = false;
  } else {
    --pending_words_;
  }
  const std::int64_t counter = run_.time & mask_, ahead = (value - counter) & mask_;
  const std::int64_t longest_gap = std::min(range_ / 4, run_.time - run_.start);
  if (value >= counter || ahead <= longest_gap) {
    run_.time += ahead;
    return;
  }
  run_.time += value - counter;
  run_.start = run_.time;
  steps_back_.add(place);
  jump_is_reported_ = true;
}

void WrappingCounter::report(Faults& faults, const char* unit) {
  std::exchange(steps_back_, {})
      .report(faults,
              "steps back of the time's counter far from the end of its range (a wrong word, events left over in a "
              "buffer, or a camera that was restarted)",
              unit);
  std::exchange(wrong_words_, {})
      .report(faults, "words of time that those before and after contradict (wrong words)", unit);
}

}  // namespace evbench
