#include "bench/pipeline/pace.hpp"

#include <algorithm>

namespace evbench {

std::optional<double> realtime_factor(double data_s, double processing_s) {
  return processing_s > 0.0 ? std::optional(data_s / processing_s) : std::nullopt;
}

std::optional<double> slowest_pace(const std::vector<std::vector<Work>>& parts, double begin, double window) {
  std::vector<Work> all;
  for (const std::vector<Work>& part : parts) all.insert(all.end(), part.begin(), part.end());
  std::ranges::stable_sort(all, {}, &Work::until);
  constexpr double kRounding = 1e-9;  // [s], of times that are sums
  double most = 0.0, inside = 0.0;
  auto first = all.begin();
  for (const Work& work : all) {
    inside += work.seconds;
    for (; first->until <= work.until - window + kRounding; ++first) inside -= first->seconds;
    if (work.until >= begin + window - kRounding) most = std::max(most, inside);
  }
  if (!(most > 0.0)) return std::nullopt;
  return window / most;
}

}  // namespace evbench
