#pragma once

#include <span>
#include <string>
#include <vector>

#include "eval/table.hpp"

namespace evbench {

struct ComparisonOptions {
  TableFormat format = TableFormat::text;  ///< not long
  bool causal = false;                     ///< as in TableOptions
  std::vector<std::string> metrics = {};   ///< of which lower or higher is better; empty: ATE, RPE, real-time factor
  TableLayout layout = {};                 ///< as in TableOptions
  std::string base = "";                   ///< name of the method with which the others are compared; empty: the first
  bool front_ends = false;                 ///< front-ends are compared, too: pairs are runs of the same sequence
};

/// A table that compares methods with one of them, pair by pair on the same data, a row per metric and method.
/// Columns: the number of pairs, failures on either side, the median ratio of own to base (of inverses if higher is
/// better, so that below 1 is always better) with its 95 % interval, the number of pairs in which the method is better,
/// Wilcoxon's p, p after Holm's correction for the comparisons of a metric, and the effect size, from −1 (better in all
/// pairs) to 1. Ratios significantly below 1 (p < 0.05 after correction) are bold. A note gives the number of pairs
/// with identical observations. paired_comparison.hpp has the definitions.
///
/// Throws InputError if there are fewer than two methods, no pair, no such base or metric (with the nearest), for a
/// metric of which neither lower nor higher is better, and for two runs of a method on the same data that are not the
/// same job.
std::string make_comparison_table(std::span<const RunRecord> runs, const ComparisonOptions& options);

}  // namespace evbench
