#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <utility>

#include "core/support/error.hpp"
#include "eval/holm.hpp"
#include "eval/paired_comparison.hpp"
#include "eval/quantile.hpp"
#include "eval/table_parts.hpp"
#include "eval/wilson.hpp"

namespace evbench {
namespace {

using Cell = TextTable::Cell;
using Group = std::vector<std::size_t>;

/// The columns that name rows, and those over which they are summarised.
struct Columns {
  std::vector<const RunColumn*> rows, over;
};

Columns split(const TableRuns& runs, const std::vector<std::string>& over) {
  Columns columns;
  for (const std::string& name : over) columns.over.push_back(&find_column(runs.columns, name));
  for (const RunColumn& column : runs.columns) {
    if (std::ranges::find(columns.over, &column) == columns.over.end()) columns.rows.push_back(&column);
  }
  return columns;
}

/// The row that is significantly better than every comparable row, if there is one.
std::optional<std::size_t> distinguished(const std::vector<Group>& rows, const TableRuns& runs, const Metric& metric,
                                         std::span<const std::size_t> data) {
  if (metric.better == Better::neither) return std::nullopt;
  std::vector<std::vector<RunCost>> costs;
  for (const Group& row : rows) costs.push_back(costs_of(row, runs.runs, metric, data, runs.protocols.of_run));
  const auto median = [&](const std::vector<RunCost>& of_row) {
    std::vector<double> values;
    for (const RunCost& cost : of_row) values.push_back(cost.cost);
    return values.empty() ? std::numeric_limits<double>::infinity() : quartiles(values).median;
  };
  const auto best = std::ranges::min_element(costs, {}, median);
  std::vector<double> p;
  for (auto other = costs.begin(); other != costs.end(); ++other) {
    if (other == best) continue;
    const std::vector<CostPair> pairs = pair_up(*best, *other);
    if (pairs.empty()) continue;
    const SignedRanks test = signed_rank_test(log_ratios(pairs));
    p.push_back(test.rank_biserial < 0.0 ? test.p : 1.0);
  }
  const std::vector<double> corrected = holm(p);
  if (p.empty() || std::ranges::max(corrected) >= kSignificant) return std::nullopt;
  return best - costs.begin();
}

/// Groups of comparable rows: of one experiment, and with common data, directly or through other rows.
std::vector<std::vector<std::size_t>> comparable_rows(const std::vector<Group>& rows, const TableRuns& runs,
                                                      std::span<const std::size_t> data) {
  struct Comparable {
    std::set<std::pair<std::string, std::size_t>> data;  // and the experiment
    std::vector<std::size_t> rows;
  };
  std::vector<Comparable> all;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    Comparable joined;
    for (const std::size_t i : rows[r]) joined.data.emplace(runs.runs[i].run().experiment, data[i]);
    const auto meets = [&](const Comparable& other) {
      return std::ranges::any_of(other.data, [&](const auto& one) { return joined.data.contains(one); });
    };
    const auto apart = std::stable_partition(all.begin(), all.end(), std::not_fn(meets));
    for (auto other = apart; other != all.end(); ++other) {
      joined.data.merge(other->data);
      joined.rows.insert(joined.rows.end(), other->rows.begin(), other->rows.end());
    }
    all.erase(apart, all.end());
    joined.rows.push_back(r);
    all.push_back(std::move(joined));
  }
  std::vector<std::vector<std::size_t>> result;
  for (Comparable& one : all) result.push_back(std::move(one.rows));
  return result;
}

std::string number_text(double value, int decimals) {
  return std::isinf(value) ? "fails" : fmt::format("{:.{}f}", value, decimals);
}

void add_metric(TextTable& table, const std::vector<Group>& rows, const TableRuns& runs, const Metric& metric,
                std::span<const std::size_t> data, const TableOptions& options) {
  std::vector<std::optional<Quartiles>> quartiles_of_rows;
  std::vector<std::optional<double>> medians;
  for (const Group& row : rows) {
    const std::vector<double> values = values_of(row, runs.runs, metric);
    quartiles_of_rows.push_back(values.empty() ? std::nullopt : std::optional(quartiles(values)));
    medians.push_back(std::nullopt);
    if (!values.empty() && std::isfinite(quartiles_of_rows.back()->median)) {
      medians.back() = metric.factor * quartiles_of_rows.back()->median;
    }
  }
  const int decimals = metric.decimals.value_or(decimals_of(medians));
  std::vector<Cell> cells;
  for (const auto& q : quartiles_of_rows) {
    cells.push_back({"-"});
    if (!q) continue;
    cells.back().text = number_text(metric.factor * q->median, decimals);
    if (std::isfinite(q->median)) cells.back().value = metric.factor * q->median;
    const bool all_fail = std::isinf(q->lower) && q->lower == q->upper;
    if (all_fail || rows[cells.size() - 1].size() == 1) continue;
    cells.back().detail = fmt::format("[{}, {}]", number_text(metric.factor * q->lower, decimals),
                                      number_text(metric.factor * q->upper, decimals));
  }
  for (const auto& of_one : comparable_rows(rows, runs, data)) {
    std::vector<Group> groups;
    for (const std::size_t r : of_one) groups.push_back(rows[r]);
    if (const auto best = distinguished(groups, runs, metric, data)) cells[of_one[*best]].best = true;
  }
  add_column(table, header_of(metric, options.format), true, std::move(cells), rank_of(metric, options), metric.key);
}

void add_metric_csv(TextTable& table, const std::vector<Group>& rows, const TableRuns& runs, const Metric& metric) {
  std::vector<Cell> cells[3];
  for (const Group& row : rows) {
    const std::vector<double> values = values_of(row, runs.runs, metric);
    const Quartiles q = quartiles(values);
    const double shown[] = {q.lower, q.median, q.upper};
    for (int k = 0; k < 3; ++k) cells[k].push_back({values.empty() ? "" : fmt::format("{}", shown[k])});
  }
  const char* names[] = {"lower", "median", "upper"};
  for (int k = 0; k < 3; ++k) add_column(table, metric.key + "." + names[k], true, std::move(cells[k]));
}

void add_names(TextTable& table, const std::vector<Group>& rows, const Columns& columns, bool csv) {
  for (const RunColumn* column : columns.rows) {
    const bool label = column->name == "label";
    if (!csv && !label && !column->varies()) continue;
    std::vector<Cell> cells;
    for (const Group& row : rows) cells.push_back({column->values[row.front()]});
    add_column(table, label && !csv ? "" : column->name, false, std::move(cells));
  }
}

std::size_t count_done(const Group& row, const TableRuns& runs) {
  return static_cast<std::size_t>(std::ranges::count_if(
      row, [&](std::size_t i) { return runs.runs[i].run().done || !runs.runs[i].run().damage.empty(); }));
}

void add_success(TextTable& table, const std::vector<Group>& rows, const TableRuns& runs, bool csv) {
  std::vector<Cell> done, succeeded, both;
  for (const Group& row : rows) {
    const std::size_t n = count_done(row, runs);
    const auto good = std::ranges::count_if(row, [&](std::size_t i) { return runs.runs[i].succeeded(); });
    done.push_back({fmt::format("{}", n)});
    succeeded.push_back({fmt::format("{}", good)});
    both.push_back({fmt::format("{} of {}", good, n)});
  }
  if (csv) add_column(table, "runs", true, std::move(done));
  add_column(table, "succeeded", true, csv ? std::move(succeeded) : std::move(both));
}

constexpr const char* kPercent = "ate.trans_percent";
constexpr double kLeastCovered = 0.9;  // least share of the time for a success

bool follows_truth(const RunNumbers& run, double percent) {
  const std::optional<double> ate = run.at(kPercent);
  return run.succeeded() && ate && *ate <= percent && run.at("final.coverage").value_or(0.0) >= kLeastCovered;
}

bool is_false_ok(const RunNumbers& run, double percent) {
  const std::optional<double> ate = run.at(kPercent);
  return run.run().done && run.run().status && run.run().status->status.state == RunState::ok && ate &&
         *ate > 2.0 * percent;
}

/// What TableOptions::success asks for.
void add_follows_truth(TextTable& table, const std::vector<Group>& rows, const TableRuns& runs,
                       const TableOptions& options, bool csv) {
  const Metric metric = metric_of(kPercent);
  std::vector<Cell> within, low, high, wrong;
  std::vector<Cell> quantiles[3];
  constexpr double kQuantiles[] = {0.5, 0.9, 1.0};
  for (const Group& row : rows) {
    const std::size_t runs_done = count_done(row, runs);
    const auto good = static_cast<std::size_t>(
        std::ranges::count_if(row, [&](std::size_t i) { return follows_truth(runs.runs[i], options.success); }));
    const auto off =
        std::ranges::count_if(row, [&](std::size_t i) { return is_false_ok(runs.runs[i], options.success); });
    if (runs_done == 0) {
      within.push_back({csv ? "" : "-"});
      low.push_back({""});
      high.push_back({""});
    } else {
      const Share share = wilson(good, runs_done);
      within.push_back({csv ? fmt::format("{}", good) : fmt::format("{:.0f} %", 100.0 * share.value), false,
                        csv ? "" : fmt::format("[{:.0f}, {:.0f}]", 100.0 * share.low, 100.0 * share.high)});
      low.push_back({fmt::format("{}", share.low)});
      high.push_back({fmt::format("{}", share.high)});
    }
    wrong.push_back({fmt::format("{}", off)});
    const std::vector<double> values = values_of(row, runs.runs, metric);
    for (int k = 0; k < 3; ++k) {
      const double value = values.empty() ? 0.0 : quantile_of(values, kQuantiles[k]);
      quantiles[k].push_back({values.empty() ? (csv ? "" : "-")
                              : csv          ? fmt::format("{}", value)
                                             : number_text(value, 2)});
    }
  }
  add_column(table, csv ? "within" : fmt::format("within {} %", options.success), true, std::move(within));
  if (csv) add_column(table, "within.low", true, std::move(low));
  if (csv) add_column(table, "within.high", true, std::move(high));
  const char* names[] = {"median", "9 of 10", "worst"};
  const char* keys[] = {"median", "p90", "max"};
  for (int k = 0; k < 3; ++k) {
    add_column(table, csv ? fmt::format("success.{}.{}", kPercent, keys[k]) : fmt::format("ATE [%], {}", names[k]),
               true, std::move(quantiles[k]));
  }
  add_column(table, csv ? "false_ok" : "false ok", true, std::move(wrong));
}

std::string success_note(const TableOptions& options) {
  return fmt::format(
      "Within {} %: runs with an ATE of at most {} % of the path, whose final trajectory covers 90 % of the time, and "
      "that are neither lost nor failed, with Wilson's 95 % interval. False ok: runs whose status is ok with an ATE of "
      "more than {} %.",
      options.success, options.success, 2.0 * options.success);
}

/// A column and its number of values: "seed (10 values)".
std::string extent(const RunColumn& column) {
  const std::set<std::string> values(column.values.begin(), column.values.end());
  return fmt::format("{} ({} value{})", column.name, values.size(), values.size() == 1 ? "" : "s");
}

/// Notes that explain the cells and bold type.
std::vector<std::string> summary_notes(const std::vector<Group>& rows, const TableRuns& runs, const Columns& columns,
                                       std::span<const std::size_t> data, const TableOptions& options) {
  std::vector<std::string> over;
  for (const RunColumn* column : columns.over) over.push_back(options.by.empty() ? extent(*column) : column->name);
  const auto fails = [](const RunNumbers& run) { return run.run().done && !run.succeeded(); };
  std::vector<std::string> notes = {fmt::format("Median [lower quartile, upper quartile] over {}.",
                                                fmt::join(over, options.by.empty() ? " and " : ", "))};
  if (std::ranges::any_of(runs.runs, fails)) {
    notes.back() += " Runs that were lost or failed count as worse than all others: fails.";
  }
  bool compared = false;
  std::set<std::string> too_few;  // notes on compared rows; none if they have enough pairs
  for (const auto& of_one : comparable_rows(rows, runs, data)) {
    if (of_one.size() < 2) continue;
    compared = true;
    std::size_t largest = 0;
    for (const std::size_t r : of_one) largest = std::max(largest, rows[r].size());
    too_few.insert(too_few_pairs(largest, of_one.size() - 1));
  }
  if (!compared) return notes;
  notes.push_back(
      fmt::format("{}: better than every other row of the same data, p < {} (Wilcoxon signed-rank, paired by data, "
                  "Holm's correction "
                  "for the number of rows).",
                  mark_name(options.format), kSignificant));
  if (!too_few.contains("")) notes.back() += *too_few.begin();
  return notes;
}

}  // namespace

TextTable summary_table(const TableRuns& runs, const TableOptions& options) {
  const bool csv = options.format == TableFormat::csv;
  const Columns columns = split(runs, options.over);
  std::vector<Group> rows = equal_runs(columns.rows, runs.runs.size());
  const auto place = [&](std::size_t i) {
    std::string text;
    for (const RunColumn* column : columns.over) (text += column->values[i]) += '\0';
    return text;
  };
  for (Group& row : rows) keep_one_of_each(row, runs.runs, place);
  const std::vector<std::size_t> data = number_data(runs.runs);
  TextTable table;
  table.rows.resize(rows.size());
  table.runs = rows;
  add_names(table, rows, columns, csv);
  add_success(table, rows, runs, csv);
  if (options.success > 0.0) add_follows_truth(table, rows, runs, options, csv);
  for (const Metric& metric : runs.metrics) {
    if (csv) add_metric_csv(table, rows, runs, metric);
    if (!csv) add_metric(table, rows, runs, metric, data, options);
  }
  if (csv)
    add_column(table, "trajectory", false, std::vector<Cell>(rows.size(), {options.causal ? "causal" : "final"}));
  table.notes = summary_notes(rows, runs, columns, data, options);
  if (options.success > 0.0) table.notes.push_back(success_note(options));
  std::ranges::move(table_notes(runs.runs, run_names(runs.columns), runs.metrics, runs.protocols, options),
                    std::back_inserter(table.notes));
  return table;
}

}  // namespace evbench
