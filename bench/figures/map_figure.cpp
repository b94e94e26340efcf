#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "bench/figures/figure_runs.hpp"
#include "core/support/error.hpp"
#include "eval/paired_comparison.hpp"

namespace evbench {
namespace {

bool has_axis(const Method& method, const RunColumn& axis) {
  return std::ranges::any_of(method.runs, [&](std::size_t run) { return !axis.values[run].empty(); });
}

/// The only method with the axis, or the only one without it.
const Method& only_method(const FigureRuns& all, const RunColumn& axis, bool with) {
  const Method* found = nullptr;
  for (const Method& method : all.methods) {
    if (has_axis(method, axis) != with) continue;
    if (found != nullptr) {
      throw InputError(fmt::format("\"{}\" and \"{}\" both have {} axis \"{}\"; expected {}", found->name, method.name,
                                   with ? "the" : "no", axis.name,
                                   with ? "one of them, by --only" : "--base with one"));
    }
    found = &method;
  }
  if (found == nullptr) {
    throw InputError(fmt::format("no method has {} axis \"{}\"; expected {}", with ? "the" : "no", axis.name,
                                 with ? "one that varies along it" : "--base with what is to be compared with"));
  }
  return *found;
}

const Method& base_of(const FigureRuns& all, const RunColumn& axis, const std::string& name) {
  return name.empty() ? only_method(all, axis, false) : find_method(all.methods, name);
}

}  // namespace

Figure map_figure(std::span<const RunRecord> runs, const FigureOptions& options) {
  if (options.axis.empty() || options.across.empty()) {
    throw InputError("a map has two axes; expected --axis and --across, each with the name of one");
  }
  if (options.axis == options.across) {
    throw InputError(fmt::format("--axis and --across are both \"{}\"; expected two axes", options.axis));
  }
  const FigureRuns all(runs, options.causal, options.axis);
  const std::vector<Metric> metrics = all.metrics(options);
  const RunColumn &axis = find_column(all.columns, options.axis), &across = find_column(all.columns, options.across);
  check_numbers(axis);
  check_numbers(across);
  const Method& base = base_of(all, axis, options.base);
  const Method& method = only_method(all, axis, true);
  const std::vector<std::size_t> data = number_data(all.runs);
  const Protocols protocols = collect_protocols(all.runs);
  std::map<std::pair<double, double>, std::vector<std::size_t>> cells;
  for (const std::size_t run : method.runs) {
    const std::optional<double> x = number_in(axis.values[run]), y = number_in(across.values[run]);
    if (x && y) cells[{*x, *y}].push_back(run);
  }
  Figure figure;
  figure.legend = false;
  figure.series.push_back({method.name});
  std::size_t pairs = 0;
  for (const Metric& metric : metrics) {
    if (metric.better == Better::neither) {
      throw InputError(fmt::format("a map of \"{}\" can't be made: neither lower nor higher is better", metric.key));
    }
    Mark mark{Mark::Kind::cells, 0, {}};
    for (const auto& [place, own] : cells) {
      const std::vector<CostPair> paired = pair_up(costs_of(own, all.runs, metric, data, protocols.of_run),
                                                   costs_of(base.runs, all.runs, metric, data, protocols.of_run));
      if (paired.empty()) continue;
      pairs = std::max(pairs, paired.size());
      mark.x.push_back(place.first);
      mark.y.push_back(place.second);
      mark.low.push_back(compare_pairs(paired).ratio);
      mark.runs.push_back(own);
    }
    if (mark.x.empty())
      throw InputError(fmt::format("no run of \"{}\" has one of \"{}\" on the same data", method.name, base.name));
    const std::string label = options.axis_label.empty() ? axis.name : options.axis_label;
    figure.panels.push_back({.x = {label}, .y = {across.name}, .marks = {std::move(mark)}, .title = metric.header});
  }
  figure.columns = figure.panels.size();
  std::string shown;
  for (const Metric& metric : metrics) shown += (shown.empty() ? "" : ", ") + metric.header;
  figure.caption =
      all.scored_caption(fmt::format("{} of {} over that of {}, on the same data: medians of up to {} pair{}. "
                                     "Below 1, blue, the former is better. Cells are of one size, "
                                     "whatever lies between their values.",
                                     shown, method.name, base.name, pairs, pairs == 1 ? "" : "s"),
                         options.causal, metrics);
  return figure;
}

}  // namespace evbench
