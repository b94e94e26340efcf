#include "core/events/event_feed.hpp"

#include <algorithm>
#include <chrono>

namespace evbench {

std::span<const Event> EventFeed::until(std::int64_t t) {
  while (next_ == events_.size() && !ended_) {
    const auto start = std::chrono::steady_clock::now();
    ended_ = !stream_->read(events_);
    seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    next_ = 0;
  }
  const auto left = std::span(events_).subspan(next_);
  const auto part =
      left.first(static_cast<std::size_t>(std::ranges::upper_bound(left, t, {}, &Event::t) - left.begin()));
  next_ += part.size();
  return part;
}

}  // namespace evbench
