#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/figures/figure_runs.hpp"

namespace evbench {
namespace {

constexpr std::size_t kColumns = 3;  ///< of panels, at most, as names are at their left

/// A method's runs under one metric.
struct Row {
  std::vector<double> values;                  ///< of the runs that did not fail
  std::vector<std::vector<std::size_t>> runs;  ///< of each of these, itself
  std::string failures;                        ///< how many failed, on one line by no-break spaces; empty: none
};

Row row_of(const Method& method, const FigureRuns& all, const Metric& metric) {
  Row row;
  std::size_t counted = 0, failed = 0;
  for (const std::size_t run : method.runs) {
    for (const double value : values_of({run}, all.runs, metric)) {
      ++counted;
      if (std::isinf(value)) {
        ++failed;
        continue;
      }
      row.values.push_back(metric.factor * value);
      row.runs.push_back({run});
    }
  }
  if (failed > 0) row.failures = fmt::format("({}\u00a0of\u00a0{}\u00a0fail)", failed, counted);
  return row;
}

}  // namespace

Figure box_figure(std::span<const RunRecord> runs, const FigureOptions& options) {
  const FigureRuns all(runs, options.causal, "", "experiment");
  const std::vector<Metric> metrics = all.metrics(options);
  Figure figure;
  figure.legend = false;
  figure.columns = std::min(metrics.size(), kColumns);
  std::vector<std::vector<std::size_t>> groups;
  for (const Method& method : all.methods) {
    figure.series.push_back({method.name});
    groups.push_back(method.runs);
  }
  bool some_failed = false;
  std::vector<std::vector<double>> drawn;  // in each panel
  std::vector<std::string> shown;          // failures that the first panel of a row shows with its names
  for (const Metric& metric : metrics) {
    const bool begins_row = figure.panels.size() % figure.columns == 0;
    if (begins_row) shown.clear();
    Panel panel{{metric.header}, {}, {}};
    drawn.emplace_back();
    for (std::size_t m = 0; m < all.methods.size(); ++m) {
      Row row = row_of(all.methods[m], all, metric);
      some_failed = some_failed || !row.failures.empty();
      if (begins_row) {
        panel.names.push_back(all.methods[m].name + (row.failures.empty() ? "" : " " + row.failures));
        shown.push_back(row.failures);
      } else {
        panel.names.push_back(row.failures == shown[m] ? "" : row.failures);
      }
      drawn.back().insert(drawn.back().end(), row.values.begin(), row.values.end());
      if (!row.values.empty()) {
        panel.marks.push_back({.kind = Mark::Kind::box,
                               .series = m,
                               .x = {static_cast<double>(m)},
                               .y = std::move(row.values),
                               .runs = std::move(row.runs)});
      }
    }
    figure.panels.push_back(std::move(panel));
  }
  for (Panel& panel : figure.panels) panel.x.log = any_spread_wide(drawn);
  const std::size_t rows = (figure.panels.size() + figure.columns - 1) / figure.columns;
  figure.height_mm = (13.0 + 6.5 * static_cast<double>(all.methods.size())) * static_cast<double>(rows);
  const std::string what = all.pooled("Boxes between quartiles, with the median and each run as a point", groups);
  figure.caption =
      all.scored_caption(what + (some_failed ? " Those that failed are in no box." : ""), options.causal, metrics);
  return figure;
}

}  // namespace evbench
