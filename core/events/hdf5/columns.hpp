#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "core/events/event.hpp"
#include "core/events/hdf5/file.hpp"

namespace evbench::hdf5 {

/// The time of an event whose x, y or t is no pixel or no time.
inline constexpr std::int64_t kBroken = std::numeric_limits<std::int64_t>::min();

/// Where x, y, t and p stand in what has been read: columns of their own, or every fourth number of rows x y t p.
struct ColumnView {
  const Values* values;
  std::size_t first = 0, step = 1;
};

/// Columns of whatever types to events: x and y in pixels; t in integer µs or floating-point s, to which `offset` [µs]
/// is added; a positive p is brighter. False when there are broken ones.
bool to_events(const ColumnView& x, const ColumnView& y, const ColumnView& t, const ColumnView& p, std::int64_t offset,
               std::span<Event> events);

/// [µs]; the largest leave room for an offset and a zero. `row` counts from the view's first.
std::int64_t to_time(const ColumnView& t, std::size_t row, std::int64_t offset);

}  // namespace evbench::hdf5
