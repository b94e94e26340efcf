#include "eval/wilcoxon.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/support/index.hpp"

namespace evbench {
namespace {

/// The ranks of sorted magnitudes, doubled so that shared mean ranks are whole numbers.
std::vector<std::size_t> doubled_ranks(const std::vector<double>& sorted) {
  std::vector<std::size_t> ranks(sorted.size());
  for (std::size_t begin = 0; begin < sorted.size();) {
    std::size_t end = begin;
    while (end < sorted.size() && sorted[end] == sorted[begin]) ++end;
    std::fill(ranks.begin() + static_cast<std::ptrdiff_t>(begin), ranks.begin() + static_cast<std::ptrdiff_t>(end),
              begin + end + 1);  // twice the mean of begin + 1 ... end
    begin = end;
  }
  return ranks;
}

/// The share of all choices of signs for which the (doubled) positive ranks sum up to at most `sum`.
double share_up_to(const std::vector<std::size_t>& ranks, std::size_t sum) {
  std::vector<double> shares(sum + 1, 0.0);  // by the sum so far; larger sums never decrease
  shares[0] = 1.0;
  for (const std::size_t rank : ranks) {
    for (std::size_t s = sum + 1; s-- > 0;) shares[s] = 0.5 * (shares[s] + (s >= rank ? shares[s - rank] : 0.0));
  }
  double share = 0.0;
  for (const double part : shares) share += part;
  return share;
}

/// The two-sided p, for the smaller one of the two sums.
double normal_p(const std::vector<std::size_t>& ranks, double smaller) {
  double total = 0.0, squares = 0.0;
  for (const std::size_t rank : ranks) {
    total += 0.5 * static_cast<double>(rank);
    squares += 0.25 * static_cast<double>(rank * rank);
  }
  const double z = (smaller - 0.5 * total) / std::sqrt(0.25 * squares);  // a sign each: variance rank² / 4
  return std::erfc(-z / std::numbers::sqrt2);
}

}  // namespace

SignedRanks signed_rank_test(std::span<const double> differences) {
  std::vector<double> sorted;
  std::ranges::copy_if(differences, std::back_inserter(sorted), [](double d) { return d != 0.0; });
  std::ranges::sort(sorted, {}, [](double d) { return std::abs(d); });
  std::vector<double> magnitudes;
  for (const double d : sorted) magnitudes.push_back(std::abs(d));
  const std::vector<std::size_t> ranks = doubled_ranks(magnitudes);

  SignedRanks result;
  result.pairs = sorted.size();
  if (sorted.empty()) return result;
  std::size_t positive = 0, negative = 0;
  for (std::size_t i = 0; i < sorted.size(); ++i) (sorted[i] > 0.0 ? positive : negative) += ranks[i];
  result.positive = 0.5 * static_cast<double>(positive);
  result.negative = 0.5 * static_cast<double>(negative);
  result.rank_biserial = (result.positive - result.negative) / (result.positive + result.negative);
  const std::size_t smaller = std::min(positive, negative);
  result.p = sorted.size() <= kExactPairs ? std::min(1.0, 2.0 * share_up_to(ranks, smaller))
                                          : normal_p(ranks, 0.5 * static_cast<double>(smaller));
  return result;
}

double smallest_p(std::size_t pairs) { return pairs == 0 ? 1.0 : std::ldexp(2.0, -static_cast<int>(pairs)); }

}  // namespace evbench
