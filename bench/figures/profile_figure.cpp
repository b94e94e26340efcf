#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>

#include "bench/figures/figure_runs.hpp"
#include "core/support/error.hpp"
#include "eval/paired_comparison.hpp"
#include "eval/performance_profile.hpp"

namespace evbench {
namespace {

/// costs[method][problem], for the data that all methods have a run on.
std::vector<std::vector<double>> costs_by_problem(const FigureRuns& all, const Metric& metric) {
  const std::vector<std::size_t> data = number_data(all.runs);
  std::map<std::size_t, std::map<std::size_t, double>> by_data;  // one cost a method
  for (std::size_t m = 0; m < all.methods.size(); ++m) {
    for (const std::size_t run : all.methods[m].runs) {
      if (const std::optional<double> cost = all.runs[run].cost(metric)) by_data[data[run]][m] = *cost;
    }
  }
  std::vector<std::vector<double>> costs(all.methods.size());
  for (const auto& [number, of_methods] : by_data) {
    if (of_methods.size() < all.methods.size()) continue;
    for (const auto& [m, cost] : of_methods) costs[m].push_back(cost);
  }
  return costs;
}

}  // namespace

Figure profile_figure(std::span<const RunRecord> runs, const FigureOptions& options) {
  const FigureRuns all(runs, options.causal);
  const std::vector<Metric> metrics = all.metrics(options);
  Figure figure;
  std::size_t problems = 0;
  for (const Method& method : all.methods) figure.series.push_back({method.name});
  for (const Metric& metric : metrics) {
    if (metric.better == Better::neither) {
      throw InputError(
          fmt::format("a profile of \"{}\" can't be made: neither lower nor higher is better; expected an "
                      "error or a time",
                      metric.key));
    }
    const std::vector<PerformanceProfile> profiles = performance_profiles(costs_by_problem(all, metric));
    problems = profiles.front().problems;
    if (problems == 0) throw InputError("there is no sequence and seed of which all methods have a run");
    double end = 1.1;
    for (const PerformanceProfile& profile : profiles) {
      if (!profile.ratios.empty()) end = std::max(end, 1.05 * profile.ratios.back());
    }
    Panel panel{{metric.header + ": at most this times the best one's", true}, {"share of runs", false, true}, {}};
    for (std::size_t m = 0; m < profiles.size(); ++m) {
      Mark steps{Mark::Kind::steps, m, {1.0}, {profiles[m].at(1.0)}};
      for (const double ratio : profiles[m].ratios) {
        steps.x.push_back(ratio);
        steps.y.push_back(profiles[m].at(ratio));
      }
      steps.x.push_back(end);
      steps.y.push_back(steps.y.back());
      panel.marks.push_back(std::move(steps));
    }
    figure.panels.push_back(std::move(panel));
  }
  figure.columns = std::min<std::size_t>(figure.panels.size(), 2);
  figure.caption = all.scored_caption(
      fmt::format("Performance profiles (Dolan and Moré 2002) over {} sequences and seeds.", problems), options.causal,
      metrics);
  return figure;
}

}  // namespace evbench
