#pragma once

#include <optional>
#include <string>
#include <vector>

#include "eval/run_columns.hpp"
#include "eval/run_numbers.hpp"
#include "eval/table.hpp"
#include "eval/table_notes.hpp"
#include "eval/table_text.hpp"

// What the kinds of tables have in common; make_table() puts them together.

namespace evbench {

/// What every table is made from.
struct TableRuns {
  std::vector<RunNumbers> runs;
  std::vector<RunColumn> columns;  ///< run_columns() of them
  Protocols protocols;
  std::vector<Metric> metrics;  ///< to be shown
};

/// A row a run.
TextTable run_table(const TableRuns& runs, const TableOptions& options);

/// A row for all runs that differ only in what options.over names.
TextTable summary_table(const TableRuns& runs, const TableOptions& options);

/// A line a run and metric.
std::string long_table(const TableRuns& runs, const TableOptions& options);

/// Decimals with which the smallest value other than 0 shows three digits, 1 to 6.
int decimals_of(const std::vector<std::optional<double>>& values);

/// What each run is called in notes: by its label, and by the other columns in which runs of that label differ.
std::vector<std::string> run_names(const std::vector<RunColumn>& columns);

void add_column(TextTable& table, const std::string& header, bool number, std::vector<TextTable::Cell> cells,
                std::size_t rank = 0);

/// The column of a metric: its header in this format, and its rank (TextTable::Column) among those that are shown.
/// None goes that was asked for.
std::string header_of(const Metric& metric, TableFormat format);
std::size_t rank_of(const Metric& metric, const TableOptions& options);

/// Is a column of text, "key", "folder" or "status", among options.metrics?
bool asks_for(const TableOptions& options, const char* column);

/// "experiment" and the like, as far as there is one.
std::vector<std::string> distinct_experiments(const TableRuns& runs);

}  // namespace evbench
