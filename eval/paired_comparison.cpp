#include "eval/paired_comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "eval/holm.hpp"
#include "eval/quantile.hpp"
#include "eval/run_columns.hpp"

namespace evbench {

std::vector<std::size_t> number_data(const std::vector<RunNumbers>& runs, PairedBy paired) {
  std::unordered_map<std::string, std::size_t> known;
  std::vector<std::size_t> numbers;
  for (const RunNumbers& run : runs) {
    std::string data = paired == PairedBy::sequence ? sequence_of(run.run()) : data_of(run.run());
    numbers.push_back(known.try_emplace(std::move(data), known.size()).first->second);
  }
  return numbers;
}

std::vector<RunCost> costs_of(std::span<const std::size_t> runs, const std::vector<RunNumbers>& numbers,
                              const Metric& metric, std::span<const std::size_t> data, std::span<const int> protocols) {
  std::vector<RunCost> costs;
  for (const std::size_t i : runs) {
    if (const std::optional<double> cost = numbers[i].cost(metric)) costs.push_back({i, data[i], protocols[i], *cost});
  }
  return costs;
}

std::vector<CostPair> pair_up(std::vector<RunCost> own, std::vector<RunCost> other) {
  std::ranges::sort(own, {}, &RunCost::data);
  std::ranges::sort(other, {}, &RunCost::data);
  std::vector<CostPair> pairs;
  for (auto a = own.begin(), b = other.begin(); a != own.end() && b != other.end();) {
    if (a->data == b->data) {
      const bool comparable = a->protocol == b->protocol || a->protocol < 0 || b->protocol < 0;
      if (comparable) pairs.push_back({a->cost, b->cost, a->run, b->run});
      ++a;
      ++b;
    } else {
      ++(a->data < b->data ? a : b);
    }
  }
  return pairs;
}

std::vector<double> log_ratios(std::span<const CostPair> pairs) {
  std::vector<double> ratios;
  for (const CostPair& pair : pairs) {
    ratios.push_back(pair.own == pair.other ? 0.0 : std::log(pair.own) - std::log(pair.other));
  }
  return ratios;
}

PairedComparison compare_pairs(std::span<const CostPair> pairs) {
  PairedComparison result;
  result.pairs = pairs.size();
  for (const CostPair& pair : pairs) {
    result.own_failed += std::isinf(pair.own) ? 1 : 0;
    result.other_failed += std::isinf(pair.other) ? 1 : 0;
    result.better += pair.own < pair.other ? 1 : 0;
    result.worse += pair.own > pair.other ? 1 : 0;
  }
  std::vector<double> ratios = log_ratios(pairs);
  result.test = signed_rank_test(ratios);
  const Interval interval = bootstrap_median(ratios);
  result.interval = {std::exp(interval.from), std::exp(interval.to)};
  std::ranges::sort(ratios);
  result.ratio = std::exp(quantile(ratios, 0.5));
  return result;
}

std::string too_few_pairs(std::size_t pairs, std::size_t comparisons) {
  const auto can_be = [&](std::size_t n) { return smallest_p(n) * static_cast<double>(comparisons) < kSignificant; };
  if (can_be(pairs)) return "";
  std::size_t enough = pairs;
  while (!can_be(enough)) ++enough;
  return fmt::format(" With {} pair{} and {} comparison{} nothing can reach that: it takes {} pairs.", pairs,
                     pairs == 1 ? "" : "s", comparisons, comparisons == 1 ? "" : "s", enough);
}

}  // namespace evbench
