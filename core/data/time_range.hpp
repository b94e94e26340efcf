#pragma once

#include <limits>

namespace evbench {

/// A closed range of times; by default, all times.
struct TimeRange {
  double from = -std::numeric_limits<double>::infinity();  ///< [s], closed
  double to = std::numeric_limits<double>::infinity();     ///< [s], closed

  bool contains(double t) const { return t >= from && t <= to; }
};

}  // namespace evbench
