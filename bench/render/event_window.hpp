#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/events/event_stream.hpp"

namespace evbench {

/// The size of a window: a duration, or a number of events.
struct WindowExtent {
  std::int64_t duration = 20000;          ///< [µs]
  std::optional<std::size_t> count = {};  ///< where set, instead of the duration
};

/// A window that moves forward over a stream. Keeps only the window's events and a chunk of the stream in memory.
class EventWindow {
 public:
  EventWindow(EventStream& stream, const WindowExtent& extent) : stream_(&stream), extent_(extent) {}

  /// The newest events before t [µs], valid until the next call. t must not be less than in a call before.
  std::span<const Event> before(std::int64_t t);

  /// Time of the first event that no window has reached [µs]; none at the end.
  std::optional<std::int64_t> next();

 private:
  bool fill();
  void trim(std::int64_t t);

  EventStream* stream_;
  WindowExtent extent_;
  std::vector<Event> window_;
  std::vector<Event> chunk_;
  std::size_t used_ = 0;  ///< of the chunk
};

}  // namespace evbench
