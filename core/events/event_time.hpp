#pragma once

#include <cmath>
#include <cstdint>

namespace evbench {

/// An event's time [µs] as that of everything else [s].
inline double seconds(std::int64_t t) { return static_cast<double>(t) / 1e6; }

/// The last microsecond of events that is not after t [s], which may be off by a rounding.
inline std::int64_t microseconds(double t) { return static_cast<std::int64_t>(std::floor(t * 1e6 + 1e-3)); }

}  // namespace evbench
