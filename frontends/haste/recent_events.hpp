#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "core/events/event.hpp"
#include "core/geometry/types.hpp"

namespace evbench::haste {

/// The newest events, in time order.
class RecentEvents {
 public:
  explicit RecentEvents(std::size_t count) : count_(count) { events_.reserve(2 * count); }

  void add(std::span<const Event> events) {
    if (events.size() > count_) events = events.last(count_);
    if (events_.size() + events.size() > 2 * count_) {
      events_.erase(events_.begin(), events_.end() - static_cast<std::ptrdiff_t>(count_ - events.size()));
    }
    events_.insert(events_.end(), events.begin(), events.end());
  }

  /// At most the requested number.
  std::span<const Event> events() const { return std::span(events_).last(std::min(count_, events_.size())); }

  /// The newest events that fill the window of a tracker at `pixel` [px]; all, where they are too few.
  std::span<const Event> window(const Vector2& pixel) const;

 private:
  std::size_t count_;
  std::vector<Event> events_;
};

}  // namespace evbench::haste
