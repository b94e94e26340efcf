#include <algorithm>

#include "bench/figures/figure_runs.hpp"
#include "core/io/text_reader.hpp"
#include "core/support/error.hpp"
#include "core/support/index.hpp"
#include "eval/quantile.hpp"

namespace evbench {
namespace {

constexpr int kPoints = 400;  ///< of a curve: the resolution of a page

/// Appends the column update_ms of a run's timing.csv.
void add_times(const std::string& folder, std::vector<double>& times) {
  TextReader file(folder + "/timing.csv");
  if (!file.next()) file.fail("is empty; expected a run's times");
  const auto column = std::ranges::find(file.columns(), "update_ms") - file.columns().begin();
  if (index(column) == file.columns().size()) file.fail("has no column update_ms; expected a run's times");
  while (file.next()) times.push_back(file.number(index(column), "update_ms"));
}

}  // namespace

Figure times_figure(std::span<const RunRecord> runs, const FigureOptions& options) {
  const FigureRuns all(runs, options.causal);
  Figure figure;
  Panel panel{{"time of an update [ms]", true}, {"share of updates", false, true}, {}};
  for (const Method& method : all.methods) {
    std::vector<double> times;
    for (const std::size_t i : method.runs) {
      if (all.runs[i].run().competes()) add_times(all.runs[i].run().folder, times);
    }
    std::ranges::sort(times);
    const std::size_t number = figure.series.size();
    figure.series.push_back({method.name});
    if (times.empty()) continue;
    Mark curve{Mark::Kind::line, number, {}};
    for (int k = 0; k <= kPoints; ++k) {
      const double share = static_cast<double>(k) / kPoints;
      curve.x.push_back(std::max(quantile(times, share), 1e-4));  // the file's last digit, for a logarithm
      curve.y.push_back(share);
    }
    panel.marks.push_back(std::move(curve));
  }
  if (panel.marks.empty()) throw InputError("none of these runs was without loss or failure; expected times to draw");
  figure.panels.push_back(std::move(panel));
  figure.caption = all.caption("Distribution of the times of all updates of all runs that succeeded.");
  return figure;
}

}  // namespace evbench
