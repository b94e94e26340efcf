#pragma once

#include <optional>

#include "bench/figures/run_figures.hpp"
#include "eval/methods.hpp"
#include "eval/table_notes.hpp"

// What the figures of runs have in common.

namespace evbench {

/// What every figure is made from.
struct FigureRuns {
  /// `without`: a column, or a setting, that is no part of methods' names, `apart`: a column that always is one
  /// (methods_of()).
  FigureRuns(std::span<const RunRecord> runs, bool causal, const std::string& without = "",
             const std::string& apart = "");

  std::vector<RunNumbers> runs;
  std::vector<RunColumn> columns;
  std::vector<Method> methods;

  /// What a figure shows, a panel each: those asked for, else ATE and RPE. Throws InputError for one that no run has.
  std::vector<Metric> metrics(const FigureOptions& options) const;

  /// A sentence: how many runs each of these groups is of, by their indices, and what they differ in. `what` begins
  /// it; of groups of one run each it says nothing, as there is nothing but these runs.
  std::string pooled(const std::string& what, const std::vector<std::vector<std::size_t>>& groups) const;

  /// Experiments, and what is drawn: a sentence.
  std::string caption(const std::string& what) const;

  /// The same of what follows from trajectories, and of these metrics: with the trajectory that they are of, and as
  /// much of the protocols as they follow from. Where all of them are times and the like that is nothing.
  std::string scored_caption(const std::string& what, bool causal, const std::vector<Metric>& metrics) const;
};

/// The number that is all of a text, if it is one.
std::optional<double> number_in(const std::string& text);

/// Throws InputError where a column has something else than numbers.
void check_numbers(const RunColumn& column);

/// Are these positive numbers so far apart that their logarithms should be drawn?
bool spread_wide(const std::vector<double>& values);

/// Should logarithms be drawn in all panels of a figure, which have these values? Where one should have them, if none
/// has a value that is not positive.
bool any_spread_wide(const std::vector<std::vector<double>>& panels);

/// run_columns(), and the setting `axis` as one of them where labels differ wherever it does, so that it is none.
std::vector<RunColumn> columns_with(std::span<const RunRecord> runs, const std::string& axis);

}  // namespace evbench
