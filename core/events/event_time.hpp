#pragma once

#include <cmath>
#include <cstdint>

#include "core/data/time_unit.hpp"

namespace evbench {

/// An event's time [µs] in seconds.
inline double seconds(std::int64_t t) { return static_cast<double>(t) / 1e6; }

/// The last microsecond that is not after t [s]; t may be off by a rounding error.
inline std::int64_t microseconds(double t) { return static_cast<std::int64_t>(std::floor(t * 1e6 + 1e-3)); }

/// Converts a whole number of `unit` to [µs], rounded. False beyond 64 bits.
inline bool to_microseconds(std::int64_t time, TimeUnit unit, std::int64_t& t) {
  if (unit == TimeUnit::nanoseconds) {
    const std::int64_t part = ((time % 1000) + 1000) % 1000;
    t = time / 1000 - (time % 1000 < 0 ? 1 : 0) + (part >= 500 ? 1 : 0);
    return true;
  }
  const std::int64_t factor = unit == TimeUnit::microseconds ? 1 : unit == TimeUnit::milliseconds ? 1000 : 1'000'000;
  return !__builtin_mul_overflow(time, factor, &t);
}

}  // namespace evbench
