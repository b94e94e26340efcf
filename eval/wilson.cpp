#include "eval/wilson.hpp"

#include <algorithm>
#include <cmath>

namespace evbench {

Share wilson(std::size_t successes, std::size_t n) {
  constexpr double z = 1.959963984540054;  // 97.5 % of the normal distribution
  const auto count = static_cast<double>(n);
  const double p = static_cast<double>(successes) / count, spread = z * z / count;
  const double middle = (p + 0.5 * spread) / (1.0 + spread);
  const double half = z / (1.0 + spread) * std::sqrt(p * (1.0 - p) / count + 0.25 * spread / count);
  return {std::clamp(middle - half, 0.0, p), p, std::clamp(middle + half, p, 1.0)};  // of rounding errors
}

}  // namespace evbench
