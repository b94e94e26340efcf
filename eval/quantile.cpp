#include "eval/quantile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/support/index.hpp"

namespace evbench {

double quantile(std::span<const double> sorted, double p) {
  if (sorted.empty()) return std::numeric_limits<double>::quiet_NaN();
  const double place = p * static_cast<double>(sorted.size() - 1);
  const std::size_t below = std::min(index(static_cast<std::ptrdiff_t>(place)), sorted.size() - 1);
  const double share = place - static_cast<double>(below);
  const double low = sorted[below], high = sorted[std::min(below + 1, sorted.size() - 1)];
  if (share == 0.0 || low == high) return low;
  if (std::isinf(low)) return std::isinf(high) ? 0.0 : low;
  return low + share * (high - low);
}

double quantile_of(std::vector<double> values, double p) {
  std::ranges::sort(values);
  return quantile(values, p);
}

Quartiles quartiles(std::vector<double> values) {
  std::ranges::sort(values);
  return {quantile(values, 0.25), quantile(values, 0.5), quantile(values, 0.75)};
}

}  // namespace evbench
