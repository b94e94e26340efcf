#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "eval/bootstrap.hpp"
#include "eval/run_numbers.hpp"
#include "eval/wilcoxon.hpp"

namespace evbench {

/// The cost of a run (RunNumbers::cost()), its data and its protocol.
struct RunCost {
  std::size_t run;   ///< its index
  std::size_t data;  ///< a number for each distinct data_of()
  int protocol;      ///< a number for each distinct protocol; -1: no scores
  double cost;
};

/// The costs of two methods on the same data.
struct CostPair {
  double own, other;
  std::size_t own_run = 0, other_run = 0;  ///< indices
};

/// What the runs of a pair have in common.
enum class PairedBy {
  observations,  ///< sequence and front-end (data_of() in run_columns.hpp): back-ends are compared
  sequence,      ///< sequence_of(): front-ends, too
};

/// Numbers the data of runs: equal numbers if runs can be compared pair by pair.
std::vector<std::size_t> number_data(const std::vector<RunNumbers>& runs, PairedBy paired = PairedBy::observations);

/// The costs of some of the runs, by index; runs without a cost (RunNumbers::cost()) are left out.
std::vector<RunCost> costs_of(std::span<const std::size_t> runs, const std::vector<RunNumbers>& numbers,
                              const Metric& metric, std::span<const std::size_t> data, std::span<const int> protocols);

/// Pairs of the same data, in its order; runs scored by different protocols make no pair. Each method has at most one
/// run for each data.
std::vector<CostPair> pair_up(std::vector<RunCost> own, std::vector<RunCost> other);

/// Logarithms of own / other; 0 if both failed, infinite if one did.
std::vector<double> log_ratios(std::span<const CostPair> pairs);

/// Comparison of one method with another on the same data, by the ratios of their costs.
struct PairedComparison {
  std::size_t pairs = 0;
  std::size_t own_failed = 0, other_failed = 0;  ///< of the pairs
  std::size_t better = 0, worse = 0;             ///< pairs in which the own cost is less, is more
  double ratio = 1.0;                            ///< median of own / other: below 1 the own method is better
  Interval interval{0.0, 0.0};                   ///< of the ratio, 95 % (bootstrap.hpp)
  SignedRanks test;                              ///< of the ratios' logarithms
};

PairedComparison compare_pairs(std::span<const CostPair> pairs);

/// A note, with a leading blank, that comparisons can't be significant (holm.hpp) because they have at most so few
/// pairs; empty if they can be.
std::string too_few_pairs(std::size_t pairs, std::size_t comparisons);

}  // namespace evbench
