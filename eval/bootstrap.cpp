#include "eval/bootstrap.hpp"

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

#include "core/support/index.hpp"
#include "eval/quantile.hpp"

namespace evbench {

Interval bootstrap_median(std::span<const double> values, const BootstrapOptions& options) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (values.size() < 2) return {-kInfinity, kInfinity};
  std::vector<double> sorted(values.begin(), values.end());
  std::ranges::sort(sorted);
  std::mt19937_64 random(options.seed);
  std::vector<double> medians, drawn(sorted.size());
  std::vector<std::size_t> times(sorted.size());  // how often each value is drawn: sorted without sorting
  for (int i = 0; i < options.samples; ++i) {
    std::ranges::fill(times, std::size_t{0});
    for (std::size_t k = 0; k < sorted.size(); ++k) ++times[random() % sorted.size()];
    auto at = drawn.begin();
    for (std::size_t k = 0; k < sorted.size(); ++k) at = std::fill_n(at, times[k], sorted[k]);
    medians.push_back(quantile(drawn, 0.5));
  }
  std::ranges::sort(medians);
  const double tail = 0.5 * (1.0 - options.level);
  return {quantile(medians, tail), quantile(medians, 1.0 - tail)};
}

}  // namespace evbench
