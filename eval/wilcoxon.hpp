#pragma once

#include <cstddef>
#include <span>

namespace evbench {

/// What Wilcoxon's signed-rank test says of paired differences.
struct SignedRanks {
  std::size_t pairs = 0;       ///< differences other than zero
  double positive = 0.0;       ///< sum of the ranks of positive differences
  double negative = 0.0;       ///< of negative ones
  double p = 1.0;              ///< two-sided: 1 where there are no pairs
  double rank_biserial = 0.0;  ///< effect size, (positive − negative) / (positive + negative), −1 to 1 (Kerby 2014)
};

/// Are the differences as often and as far above zero as below it (Wilcoxon 1945)? Differences of zero are left out,
/// equal magnitudes share their mean rank. Up to kExactPairs pairs p is exact, over all signs of the ranks as they are,
/// shared ones included; beyond, it is normal with the variance that shared ranks leave, without a correction of
/// continuity. Differences may be infinite, as where one of two failed: they rank above all others. None may be NaN.
SignedRanks signed_rank_test(std::span<const double> differences);
inline constexpr std::size_t kExactPairs = 50;

/// The smallest p that so many pairs can have: 2 / 2^n, at most 1.
double smallest_p(std::size_t pairs);

}  // namespace evbench
