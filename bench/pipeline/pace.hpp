#pragma once

#include <optional>
#include <vector>

namespace evbench {

/// Processing time of one batch.
struct Work {
  double until = 0.0;    ///< [s] sequence time of the batch's end
  double seconds = 0.0;  ///< [s] wall time
  bool operator==(const Work&) const = default;
};

/// Data time / processing time of front-end and back-end: above 1 is faster than real time; none if the processing time
/// is zero. `data_s`: [s] from the first to the last observation.
std::optional<double> realtime_factor(double data_s, double processing_s);

/// Data time / processing time of the slowest window of the data. `window` is its length [s]; it ends at the end of a
/// batch. None if the data are shorter. The work of several parts, each in time order, is summed as in one thread.
/// `begin`: of the data [s].
std::optional<double> slowest_pace(const std::vector<std::vector<Work>>& parts, double begin, double window);

}  // namespace evbench
