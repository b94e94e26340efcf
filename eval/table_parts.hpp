#pragma once

#include <optional>
#include <string>
#include <vector>

#include "eval/run_columns.hpp"
#include "eval/run_numbers.hpp"
#include "eval/table.hpp"
#include "eval/table_notes.hpp"
#include "eval/table_text.hpp"

// Common parts of all kinds of tables, for make_table().

namespace evbench {

/// The input of every table.
struct TableRuns {
  std::vector<RunNumbers> runs;
  std::vector<RunColumn> columns;  ///< run_columns() of them
  Protocols protocols;
  std::vector<Metric> metrics;  ///< to be shown
};

/// A table with a row per run.
TextTable run_table(const TableRuns& runs, const TableOptions& options);

/// A table with a row for all runs that differ only in the columns options.over.
TextTable summary_table(const TableRuns& runs, const TableOptions& options);

/// A CSV with a line per run and metric.
std::string long_table(const TableRuns& runs, const TableOptions& options);

/// The decimals, 1 to 6, with which the smallest value other than 0 has three digits.
int decimals_of(const std::vector<std::optional<double>>& values);

/// The names of runs in notes: the label, and the other columns in which runs of that label differ.
std::vector<std::string> run_names(const std::vector<RunColumn>& columns);

void add_column(TextTable& table, const std::string& header, bool number, std::vector<TextTable::Cell> cells,
                std::size_t rank = 0, const std::string& key = "");

/// The column of a metric: its header in this format, and its rank (TextTable::Column). Requested columns are never
/// left out.
std::string header_of(const Metric& metric, TableFormat format);
std::size_t rank_of(const Metric& metric, const TableOptions& options);

/// Whether a text column, "key", "folder" or "status", is among options.metrics.
bool asks_for(const TableOptions& options, const char* column);

/// The distinct values of the column "experiment"; empty if there is none.
std::vector<std::string> distinct_experiments(const TableRuns& runs);

}  // namespace evbench
