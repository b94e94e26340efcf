#pragma once

#include <optional>
#include <vector>

namespace evbench {

/// What was done for the data up to a time, since what was done before it.
struct Work {
  double until = 0.0;    ///< [s] of the sequence
  double seconds = 0.0;  ///< that it took
  bool operator==(const Work&) const = default;
};

/// Data time / processing time, of front-end and back-end: above 1 is faster than real time; none where nothing took
/// time. `data_s` goes from the first to the last observation.
std::optional<double> realtime_factor(double data_s, double processing_s);

/// Data time / processing time of the slowest `window` [s] of the data that end where some of the work does; none where
/// the work is not of that long. The work of several parts, each in time order, adds up, as in one thread. `begin`: of
/// the data [s].
std::optional<double> slowest_pace(const std::vector<std::vector<Work>>& parts, double begin, double window);

}  // namespace evbench
