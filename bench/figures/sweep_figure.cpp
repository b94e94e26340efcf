#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "bench/figures/figure_runs.hpp"
#include "core/support/error.hpp"
#include "eval/quantile.hpp"

namespace evbench {
namespace {

bool is_numeric_axis(const RunColumn& column) {
  const bool names = column.name == "experiment" || column.name == "label" || column.name == "seed";
  return !names && column.varies() &&
         std::ranges::all_of(column.values, [](const std::string& value) { return value.empty() || number_in(value); });
}

/// The axis asked for, or the only one that has numbers.
std::string axis_of(std::span<const RunRecord> runs, const FigureOptions& options) {
  const std::vector<RunColumn> columns = run_columns(runs);
  if (!options.axis.empty()) {
    check_numbers(find_column(columns, options.axis));
    return options.axis;
  }
  std::vector<std::string> names;
  for (const RunColumn& column : columns) {
    if (is_numeric_axis(column)) names.push_back(column.name);
  }
  if (names.empty()) throw InputError("these runs differ in no number; expected runs of a sweep");
  if (names.size() > 1) {
    throw InputError(
        fmt::format("these runs differ in \"{}\" and \"{}\"; expected --axis with one of them", names[0], names[1]));
  }
  return names.front();
}

/// Of a method at one value of the axis.
struct Spot {
  Quartiles quartiles;
  std::ptrdiff_t failed;
};

Spot spot_of(const std::vector<std::size_t>& runs, const FigureRuns& all, const Metric& metric) {
  std::vector<double> values = values_of(runs, all.runs, metric);
  const auto failed = std::ranges::count_if(values, [](double value) { return std::isinf(value); });
  for (double& value : values) value *= metric.factor;
  return {quartiles(std::move(values)), failed};
}

/// The marks of one method in a panel.
std::vector<Mark> draw_method(const Method& method, std::size_t number, const RunColumn& axis, const FigureRuns& all,
                              const Metric& metric) {
  std::map<double, std::vector<std::size_t>> at;
  std::vector<std::size_t> without;
  for (const std::size_t run : method.runs) {
    const std::optional<double> x = number_in(axis.values[run]);
    (x ? at[*x] : without).push_back(run);
  }
  std::vector<Mark> marks;
  if (!without.empty()) {
    const Quartiles q = spot_of(without, all, metric).quartiles;
    marks.push_back({Mark::Kind::level, number, {}, {q.median}, {q.lower}, {q.upper}});
  }
  Mark curve{Mark::Kind::points, number, {}}, band{Mark::Kind::band, number, {}};
  for (const auto& [x, runs] : at) {
    const Spot spot = spot_of(runs, all, metric);
    if (spot.failed > 0)
      marks.push_back({Mark::Kind::note, number, {x}, {}, {}, {}, fmt::format("{} fail", spot.failed)});
    curve.x.push_back(x);
    curve.y.push_back(spot.quartiles.median);
    band.low.push_back(spot.quartiles.lower);
    band.high.push_back(spot.quartiles.upper);
  }
  band.x = curve.x;
  if (!curve.x.empty()) {
    marks.push_back(std::move(band));
    marks.push_back(std::move(curve));
  }
  return marks;
}

}  // namespace

Figure sweep_figure(std::span<const RunRecord> runs, const FigureOptions& options) {
  const std::string name = axis_of(runs, options);
  const FigureRuns all(runs, options.online, name);
  const std::vector<Metric> metrics = all.metrics(options);
  const RunColumn& axis = find_column(all.columns, name);
  Figure figure;
  for (const Method& method : all.methods) figure.series.push_back({method.name});
  std::vector<double> places;
  for (const std::string& value : axis.values) places.push_back(number_in(value).value_or(NAN));
  for (const Metric& metric : metrics) {
    Panel panel{{options.axis_label.empty() ? name : options.axis_label, spread_wide(places)}, {metric.header}, {}};
    std::vector<double> heights;
    for (std::size_t m = 0; m < all.methods.size(); ++m) {
      for (Mark& mark : draw_method(all.methods[m], m, axis, all, metric)) {
        heights.insert(heights.end(), mark.y.begin(), mark.y.end());
        panel.marks.push_back(std::move(mark));
      }
    }
    panel.y.log = spread_wide(heights);
    figure.panels.push_back(std::move(panel));
  }
  figure.columns = std::min<std::size_t>(figure.panels.size(), 2);
  figure.height_mm = 64.0 * std::ceil(static_cast<double>(figure.panels.size()) / 2.0);
  std::string what = "Medians, and bands between quartiles";
  std::set<std::string> seeds;
  for (const Method& method : all.methods) {
    for (const std::size_t run : method.runs) seeds.insert(find_column(all.columns, "seed").values[run]);
  }
  if (seeds.size() > 1) what += fmt::format(", of {} seeds", seeds.size());
  figure.caption = all.scored_caption(what + ".", options.online);
  return figure;
}

}  // namespace evbench
