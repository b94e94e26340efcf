#pragma once

#include <limits>

namespace evbench::gp_map {

/// After `from`, up to and with `until` [s]; by default, all times.
struct TimeSpan {
  double from = -std::numeric_limits<double>::infinity(), until = std::numeric_limits<double>::infinity();

  bool has(double t) const { return from < t && t <= until; }

  bool is_everything() const { return from == TimeSpan().from && until == TimeSpan().until; }

  /// Whether some of the times in (t0, t1] are in it.
  bool meets(double t0, double t1) const { return from < t1 && t0 < until; }
};

}  // namespace evbench::gp_map
