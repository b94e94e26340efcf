#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace evbench {

/// The quantile `share` of the values, 0 ≤ share < 1. Precondition: not empty.
inline double order_statistic(std::vector<double> values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size()));
  std::ranges::nth_element(values, at);
  return *at;
}

/// The upper median. Precondition: not empty.
inline double median(std::vector<double> values) { return order_statistic(std::move(values), 0.5); }

}  // namespace evbench
