#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "core/events/event.hpp"

namespace evbench {

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

  /// All that are kept: at most the number given at first.
  std::span<const Event> events() const { return newest(count_); }
  /// At most the requested number.
  std::span<const Event> newest(std::size_t count) const {
    return std::span(events_).last(std::min({count, count_, events_.size()}));
  }

 private:
  std::size_t count_;
  std::vector<Event> events_;
};

}  // namespace evbench
