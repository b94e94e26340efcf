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
  std::string base = "";                   ///< what the others are compared with: a method's name; empty: the first
};

/// A table that compares methods with one of them, pair by pair on the same data, a row a metric and method: the number
/// of pairs, of failures on either side, the median ratio of own to base (of errors and times; of inverses where higher
/// is better, so that below 1 is better always) with its 95 % interval, in how many pairs it is better, Wilcoxon's p,
/// the same by Holm's correction for the comparisons of a metric, the effect size, −1 where the method is better in all
/// pairs to 1. Ratios that are significantly below 1 (p < 0.05 after correction) are bold. Below stands in how many
/// pairs the observations were identical. paired_comparison.hpp has the definitions.
///
/// Throws InputError where there are fewer than two methods, no pair at all, no such base or metric (with the nearest),
/// for a metric of which neither lower nor higher is better, and for two runs of a method on the same data that are not
/// the same job.
std::string make_comparison_table(std::span<const RunRecord> runs, const ComparisonOptions& options);

}  // namespace evbench
