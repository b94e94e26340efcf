#pragma once

#include <array>

#include "core/events/event.hpp"
#include "core/support/index.hpp"
#include "frontends/haste/tracking/hypotheses.hpp"

namespace evbench::haste {

/// The newest kWindowSize events in a tracker's range. An event keeps its slot until another takes it.
class EventWindow {
 public:
  /// Takes the oldest event's slot, whose number is returned.
  int push(const Event& event) {
    const int slot = oldest_;
    events_[index(slot)] = event;
    oldest_ = after(slot);
    return slot;
  }

  const Event& slot(int i) const { return events_[index(i)]; }
  /// The slot of the i-th event, the oldest being the 0th; when the window is full.
  int slot_of(int i) const { return oldest_ + i < kWindowSize ? oldest_ + i : oldest_ + i - kWindowSize; }
  int oldest_slot() const { return oldest_; }

  const Event& event(int i) const { return slot(slot_of(i)); }
  const Event& middle() const { return event(kWindowSize / 2); }
  const Event& newest() const { return event(kWindowSize - 1); }

 private:
  static int after(int slot) { return slot + 1 < kWindowSize ? slot + 1 : 0; }

  std::array<Event, kWindowSize> events_{};
  int oldest_ = 0;
};

}  // namespace evbench::haste
