#pragma once

#include <array>

#include "core/events/event.hpp"
#include "core/support/index.hpp"
#include "frontends/haste/tracking/hypotheses.hpp"

namespace evbench::haste {

/// The newest kWindowSize events in a tracker's range. An event keeps its slot until another takes it.
class EventWindow {
 public:
  /// Returns the event whose place the new one takes: the oldest.
  Event push(const Event& event) {
    const Event replaced = events_[index(oldest_)];
    events_[index(oldest_)] = event;
    oldest_ = oldest_ + 1 < kWindowSize ? oldest_ + 1 : 0;
    return replaced;
  }

  const Event& slot(int i) const { return events_[index(i)]; }
  /// The slot of the i-th event, the oldest being the 0th; when the window is full.
  int slot_of(int i) const { return oldest_ + i < kWindowSize ? oldest_ + i : oldest_ + i - kWindowSize; }

  const Event& event(int i) const { return slot(slot_of(i)); }
  const Event& middle() const { return event(kWindowSize / 2); }
  const Event& newest() const { return event(kWindowSize - 1); }

 private:
  std::array<Event, kWindowSize> events_{};
  int oldest_ = 0;
};

}  // namespace evbench::haste
