#include "eval/performance_profile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace evbench {

double PerformanceProfile::at(double tau) const {
  const auto solved = std::ranges::upper_bound(ratios, tau) - ratios.begin();
  return problems == 0 ? 0.0 : static_cast<double>(solved) / static_cast<double>(problems);
}

std::vector<PerformanceProfile> performance_profiles(std::span<const std::vector<double>> costs) {
  std::vector<PerformanceProfile> profiles(costs.size());
  const std::size_t problems = costs.empty() ? 0 : costs.front().size();
  for (PerformanceProfile& profile : profiles) profile.problems = problems;
  for (std::size_t problem = 0; problem < problems; ++problem) {
    double least = std::numeric_limits<double>::infinity();
    for (const std::vector<double>& of_method : costs) least = std::min(least, of_method[problem]);
    for (std::size_t method = 0; method < costs.size(); ++method) {
      const double cost = costs[method][problem];
      const double ratio = cost == least ? 1.0 : cost / least;  // also for 0 / 0
      if (std::isfinite(cost) && std::isfinite(ratio)) profiles[method].ratios.push_back(ratio);
    }
  }
  for (PerformanceProfile& profile : profiles) std::ranges::sort(profile.ratios);
  return profiles;
}

}  // namespace evbench
