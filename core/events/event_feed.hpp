#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/events/event_stream.hpp"

namespace evbench {

/// A source's events, one after the other, up to any requested time.
class EventFeed {
 public:
  explicit EventFeed(std::unique_ptr<EventStream> stream) : stream_(std::move(stream)) {}

  /// The next events with times ≤ t [µs], valid until the next call: some of them, and at least one while there are
  /// any. Empty: all events left are later, or none is left.
  std::span<const Event> until(std::int64_t t);

  const EventStream& stream() const { return *stream_; }
  double seconds() const { return seconds_; }  ///< [s] spent reading them

  /// No event is left.
  bool ended() const { return ended_ && next_ == events_.size(); }

 private:
  std::unique_ptr<EventStream> stream_;
  std::vector<Event> events_;
  std::size_t next_ = 0;
  bool ended_ = false;
  double seconds_ = 0.0;
};

}  // namespace evbench
