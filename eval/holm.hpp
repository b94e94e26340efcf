#pragma once

#include <span>
#include <vector>

namespace evbench {

/// Below this p, corrected for the number of comparisons, a difference is called significant.
inline constexpr double kSignificant = 0.05;

/// p-values of several comparisons, each made as large as it must be so that together they are wrong about any one with
/// no more than the probability that is tested for (Holm 1979). In the same order.
std::vector<double> holm(std::span<const double> p);

}  // namespace evbench
