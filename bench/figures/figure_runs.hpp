#pragma once

#include <optional>

#include "bench/figures/run_figures.hpp"
#include "eval/methods.hpp"
#include "eval/table_notes.hpp"

// Shared by the figures of runs.

namespace evbench {

/// The runs that a figure is made from.
struct FigureRuns {
  /// `without`: a column, or a setting, that is no part of methods' names, `apart`: a column that always is one
  /// (methods_of()).
  FigureRuns(std::span<const RunRecord> runs, bool causal, const std::string& without = "",
             const std::string& apart = "");

  std::vector<RunNumbers> runs;
  std::vector<RunColumn> columns;
  std::vector<Method> methods;

  /// The metrics of a figure, one a panel: the requested ones, else ATE and RPE. Throws InputError for one that no run
  /// has.
  std::vector<Metric> metrics(const FigureOptions& options) const;

  /// A sentence that begins with `what`: the number of runs in each of these groups of run indices, and what the runs
  /// of a group differ in. Empty for groups of one run each.
  std::string pooled(const std::string& what, const std::vector<std::vector<std::size_t>>& groups) const;

  /// A sentence: the experiments, and what is drawn.
  std::string caption(const std::string& what) const;

  /// The same for results of trajectories, and for these metrics: with the trajectory that they are of, and the part of
  /// the protocol that they depend on. Metrics such as times depend on none.
  std::string scored_caption(const std::string& what, bool causal, const std::vector<Metric>& metrics) const;
};

/// The number that a whole text is, if it is one.
std::optional<double> number_in(const std::string& text);

/// Whether the runs differ in this column, and it has numbers alone that are not a name: it can be an axis.
bool is_numeric_axis(const RunColumn& column);

/// Throws InputError where a column has anything but numbers.
void check_numbers(const RunColumn& column);

/// Whether these are positive numbers so far apart that a logarithmic axis is needed.
bool spread_wide(const std::vector<double>& values);

/// Whether all panels of a figure with these values get a logarithmic axis: where one panel needs it and no value is
/// zero or negative.
bool any_spread_wide(const std::vector<std::vector<double>>& panels);

/// run_columns(), with the setting `axis` added where labels always differ with it, so that it is no column by itself.
std::vector<RunColumn> columns_with(std::span<const RunRecord> runs, const std::string& axis);

}  // namespace evbench
