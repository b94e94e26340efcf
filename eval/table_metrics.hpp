#pragma once

#include <optional>
#include <string>
#include <vector>

#include "eval/table.hpp"

namespace evbench {

/// A run and what metrics.json says of it, where columns are looked up.
struct Row {
  const RunRecord* run;
  Json metrics;
};
using Rows = std::vector<Row>;

enum class Better { neither, lower, higher };

/// In which tables a column stands where no columns are asked for: in LaTeX's, which must fit on a page, too; in all
/// others; in none.
enum class Shown { in_print, on_screen, on_request };

/// A column: a number found in every run's metrics.
struct Metric {
  std::string key;     ///< path into metrics.json or into its scores
  std::string header;  ///< for people
  Better better = Better::neither;
  std::optional<int> decimals = {};  ///< fixed; else as many as the smallest value of the column needs for three digits
  double factor = 1.0;               ///< shown is factor times the value
  Shown shown = Shown::on_screen;
};

/// The column of a number, known or not.
Metric metric_of(const std::string& key);

/// null where the run has none.
const Json& scores_of(const Row& row, bool online);

/// The number at a path like "ate.trans_m.rmse" of the scores, or else of all metrics, if there is one.
std::optional<double> value_of(const Row& row, const std::string& key, bool online);

/// The columns to show: those asked for, else the default ones that at least one run has. Throws InputError for one
/// that no run has.
std::vector<Metric> choose_metrics(const Rows& rows, const TableOptions& options);

}  // namespace evbench
