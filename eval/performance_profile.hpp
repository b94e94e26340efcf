#pragma once

#include <span>
#include <vector>

namespace evbench {

/// The performance profile of one method among several (Dolan and Moré 2002): the share of problems that it solves at
/// a cost of at most τ times that of the best of them.
struct PerformanceProfile {
  std::vector<double> ratios;  ///< own cost / least cost, ≥ 1, rising, of the problems that it solves
  std::size_t problems = 0;    ///< solved or not, by whomever

  /// The share at τ, 0 to 1.
  double at(double tau) const;
};

/// costs[method][problem], as many problems for each method, each cost ≥ 0, infinite where it failed. A profile a
/// method.
std::vector<PerformanceProfile> performance_profiles(std::span<const std::vector<double>> costs);

}  // namespace evbench
