#pragma once

#include <span>
#include <vector>

namespace evbench {

/// The performance profile of one of several methods (Dolan and Moré 2002): the share of problems that it solves at a
/// cost of at most τ times that of the best method.
struct PerformanceProfile {
  std::vector<double> ratios;  ///< own cost / least cost, ≥ 1, rising, of the problems that it solves
  std::size_t problems = 0;    ///< all problems, solved or not

  /// The share at τ, 0 to 1.
  double at(double tau) const;
};

/// Returns a profile for each method. costs[method][problem] is ≥ 0, infinite for a failure; all methods have the same
/// problems.
std::vector<PerformanceProfile> performance_profiles(std::span<const std::vector<double>> costs);

}  // namespace evbench
