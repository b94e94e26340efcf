#pragma once

#include <span>
#include <vector>

namespace evbench {

/// A difference is significant if its p, corrected for the number of comparisons, is below this.
inline constexpr double kSignificant = 0.05;

/// Holm's correction (1979) of the p-values of several comparisons, in the same order: it bounds the probability that
/// any of them is falsely significant.
std::vector<double> holm(std::span<const double> p);

}  // namespace evbench
