#pragma once

#include <cstdint>
#include <span>

namespace evbench {

struct Interval {
  double from, to;
};

struct BootstrapOptions {
  double level = 0.95;
  int samples = 10'000;
  std::uint64_t seed = 1;  ///< the same values and seed give the same digits
};

/// Confidence interval of the median of the values' distribution, with the probability `level`: percentiles of the
/// medians of `samples` draws with replacement (Efron 1979). Values may be infinite, but not NaN. For fewer than two
/// values it is −∞ to ∞.
Interval bootstrap_median(std::span<const double> values, const BootstrapOptions& options = {});

}  // namespace evbench
