#pragma once

#include <cstddef>
#include <span>

namespace evbench {

/// Result of Wilcoxon's signed-rank test of paired differences.
struct SignedRanks {
  std::size_t pairs = 0;       ///< differences other than zero
  double positive = 0.0;       ///< sum of the ranks of positive differences
  double negative = 0.0;       ///< of negative ones
  double p = 1.0;              ///< two-sided; 1 if there are no pairs
  double rank_biserial = 0.0;  ///< effect size, (positive − negative) / (positive + negative), −1 to 1 (Kerby 2014)
};

/// Tests whether the differences are symmetric about zero (Wilcoxon 1945). Differences of zero are left out, equal
/// magnitudes share their mean rank. Up to kExactPairs pairs p is exact, over all signs of the ranks, shared ones
/// included; beyond, it is from the normal approximation with the variance of shared ranks, without continuity
/// correction. Differences may be infinite, e.g. if one of two runs failed: they rank above all others. None may be
/// NaN.
SignedRanks signed_rank_test(std::span<const double> differences);
inline constexpr std::size_t kExactPairs = 50;

/// The smallest possible p of n pairs: 2 / 2^n, at most 1.
double smallest_p(std::size_t pairs);

}  // namespace evbench
