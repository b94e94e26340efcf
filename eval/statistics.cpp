#include "eval/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace evbench {

Statistics statistics(std::span<const double> errors) {
  Statistics result;
  if (errors.empty()) return result;
  std::vector<double> sorted(errors.begin(), errors.end());
  std::ranges::sort(sorted);
  const std::size_t n = sorted.size();
  const auto count = static_cast<double>(n);
  result.n = n;
  result.min = sorted.front();
  result.max = sorted.back();
  result.median = n % 2 == 1 ? sorted[n / 2] : 0.5 * (sorted[n / 2 - 1] + sorted[n / 2]);
  result.mean = std::accumulate(errors.begin(), errors.end(), 0.0) / count;
  double spread = 0.0;
  for (const double error : errors) {
    result.sse += error * error;
    spread += (error - result.mean) * (error - result.mean);
  }
  result.rmse = std::sqrt(result.sse / count);
  result.std = std::sqrt(spread / count);
  return result;
}

Json to_json(const Statistics& s) {
  const auto number = [](double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); };
  return {{"rmse", number(s.rmse)}, {"mean", number(s.mean)}, {"median", number(s.median)}, {"std", number(s.std)},
          {"min", number(s.min)},   {"max", number(s.max)},   {"sse", number(s.sse)},       {"n", s.n}};
}

}  // namespace evbench
