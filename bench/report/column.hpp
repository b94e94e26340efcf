#pragma once

#include <span>
#include <vector>

#include "core/support/json.hpp"

namespace evbench::report {

/// A series of numbers as the page reads it (bench/report/page/src/data.ts, Column). NaN: missing.
/// Times [s]: equidistant ones as three numbers, others to half a millisecond.
Json times(std::span<const double> values);
/// Values in single precision: for a few that are far from the others.
Json single(std::span<const double> values);
/// Values as 16-bit integers between their least and largest: off by at most 1/65,000 of that range.
Json coarse(std::span<const double> values);

}  // namespace evbench::report
