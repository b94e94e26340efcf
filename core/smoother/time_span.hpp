#pragma once

#include <limits>

namespace evbench::smoother {

/// Times after `from`, up to and including `until` [s]; by default, all times.
struct TimeSpan {
  double from = -std::numeric_limits<double>::infinity(), until = std::numeric_limits<double>::infinity();

  bool has(double t) const { return from < t && t <= until; }

  bool is_everything() const { return from == TimeSpan().from && until == TimeSpan().until; }

  /// Does it contain some of the times in (t0, t1]?
  bool overlaps(double t0, double t1) const { return from < t1 && t0 < until; }
};

}  // namespace evbench::smoother
