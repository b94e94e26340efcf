#pragma once

#include <cstdint>

namespace evbench {

/// A brightness change at a pixel. Time is an integer count of microseconds; seconds in double only at the edges.
struct Event {
  std::int64_t t = 0;  ///< [µs]
  std::uint16_t x = 0, y = 0;
  bool on = false;  ///< polarity: brighter

  friend bool operator==(const Event&, const Event&) = default;
};
static_assert(sizeof(Event) == 16);

}  // namespace evbench
