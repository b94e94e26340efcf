#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/events/event_stream.hpp"

namespace evbench {

/// A source's events in pieces that end where one wants them to.
class EventFeed {
 public:
  explicit EventFeed(std::unique_ptr<EventStream> stream) : stream_(std::move(stream)) {}

  /// The next events with times ≤ t [µs], valid until the next call; a piece of them, never none as long as there are
  /// more. None: later ones alone are left, or no events at all.
  std::span<const Event> until(std::int64_t t);

  const EventStream& stream() const { return *stream_; }
  double seconds() const { return seconds_; }  ///< [s] it took to read them

  /// Nothing is left.
  bool ended() const { return ended_ && next_ == events_.size(); }

 private:
  std::unique_ptr<EventStream> stream_;
  std::vector<Event> events_;
  std::size_t next_ = 0;
  bool ended_ = false;
  double seconds_ = 0.0;
};

}  // namespace evbench
