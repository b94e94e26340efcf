#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "core/data/time_unit.hpp"
#include "core/events/event.hpp"
#include "core/events/hdf5/file.hpp"

namespace evbench::hdf5 {

/// Times that mark a broken event: its x, y or t is no pixel or no time, or its polarity is none.
inline constexpr std::int64_t kBroken = std::numeric_limits<std::int64_t>::min(), kNoPolarity = kBroken + 1;

/// Where a column is in the values read: it is all of them, or every n-th number of rows of n.
struct ColumnView {
  const Values* values = nullptr;
  std::size_t first = 0, step = 1;
};

struct ColumnViews {
  ColumnView x, y, t, p;
};

/// Unit of the numbers of t, and the offset that is added to them.
struct TimeScale {
  TimeUnit unit = TimeUnit::microseconds;
  std::int64_t offset = 0;  ///< [µs]
};

/// The number for darker, where 1 is brighter. −1 may be stored as the largest number of an unsigned type of 8, 16, 32
/// or 64 bits. Unsaid: no event has shown it so far, and either is accepted.
enum class Darker { unsaid, zero, minus_one };

/// Finds the number for darker: the one that most events have.
class DarkerCount {
 public:
  void add(const ColumnView& p, std::size_t count);
  Darker darker() const;

 private:
  std::size_t zeros_ = 0, minus_ones_ = 0;
};

/// Converts columns of any types to events. False if some are broken.
bool to_events(const ColumnViews& columns, const TimeScale& scale, Darker darker, std::span<Event> events);

/// The time of a row [µs]; at most so large that an offset and a zero can be added. `row` counts from the view's first.
std::int64_t to_time(const ColumnView& t, std::size_t row, const TimeScale& scale);

double to_double(const ColumnView& column, std::size_t row);

}  // namespace evbench::hdf5
