#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "core/events/event.hpp"

namespace evbench {

/// Writes an event as two words of 64 bits: compilers vectorise loops of this, but not loops that set one member after
/// the other.
/// `pixel`: x | y << 16 | on << 32.
inline void store_event(std::uint64_t t, std::uint64_t pixel, Event* event) {
  static_assert(std::endian::native == std::endian::little && offsetof(Event, t) == 0 && offsetof(Event, x) == 8 &&
                offsetof(Event, y) == 10 && offsetof(Event, on) == 12 && std::is_trivially_copyable_v<Event>);
  auto* const to = reinterpret_cast<std::byte*>(event);
  std::memcpy(to, &t, sizeof t);
  std::memcpy(to + sizeof t, &pixel, sizeof pixel);
}

}  // namespace evbench
