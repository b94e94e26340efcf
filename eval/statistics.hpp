#pragma once

#include <cstddef>
#include <limits>
#include <span>

#include "core/plugin/options.hpp"

namespace evbench {

/// Statistics of a set of errors, in their unit. For an empty set all but n and sse are NaN (null in JSON).
struct Statistics {
  static constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();

  double rmse = kUndefined;    ///< root of the mean square
  double mean = kUndefined;    ///<
  double median = kUndefined;  ///< for an even number the mean of the two in the middle
  double std = kUndefined;     ///< of the population: divided by n, not n − 1
  double min = kUndefined;     ///<
  double max = kUndefined;     ///<
  double sse = 0.0;            ///< sum of squares
  std::size_t n = 0;           ///< number of errors
};

Statistics statistics(std::span<const double> errors);

/// {"rmse", "mean", "median", "std", "min", "max", "sse", "n"}
Json to_json(const Statistics& statistics);

}  // namespace evbench
