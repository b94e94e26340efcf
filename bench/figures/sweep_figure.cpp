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

/// The requested axis, or the only one that has numbers.
std::string axis_of(std::span<const RunRecord> runs, const FigureOptions& options) {
  const std::vector<RunColumn> columns = columns_with(runs, options.axis);
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

/// The runs of a method.
struct Places {
  std::map<double, std::vector<std::size_t>> at;  ///< by their value of the axis
  std::vector<std::size_t> without;               ///< runs without the axis
};

Places places_of(const Method& method, const RunColumn& axis) {
  Places places;
  for (const std::size_t run : method.runs) {
    const std::optional<double> x = number_in(axis.values[run]);
    (x ? places.at[*x] : places.without).push_back(run);
  }
  return places;
}

/// A method's values at one value of the axis.
struct Spot {
  Quartiles quartiles;
  double runs, failed;  ///< how many
};

Spot spot_of(const std::vector<std::size_t>& runs, const FigureRuns& all, const Metric& metric) {
  std::vector<double> values = values_of(runs, all.runs, metric);
  const auto failed = std::ranges::count_if(values, [](double value) { return std::isinf(value); });
  const auto runs_counted = static_cast<double>(values.size());
  for (double& value : values) value *= metric.factor;
  return {quartiles(std::move(values)), runs_counted, static_cast<double>(failed)};
}

/// The marks of one method in a panel.
std::vector<Mark> draw_method(const Places& places, std::size_t number, const FigureRuns& all, const Metric& metric) {
  std::vector<Mark> marks;
  if (!places.without.empty()) {
    const Spot spot = spot_of(places.without, all, metric);
    const Quartiles& q = spot.quartiles;
    marks.push_back({Mark::Kind::level, number, {}, {q.median}, {q.lower}, {q.upper}, {places.without}});
    if (spot.failed > 0) marks.push_back({Mark::Kind::failures, number, {}, {}, {spot.failed}, {spot.runs}});
  }
  Mark curve{Mark::Kind::points, number, {}}, band{Mark::Kind::band, number, {}};
  Mark failures{Mark::Kind::failures, number, {}};
  for (const auto& [x, runs] : places.at) {
    const Spot spot = spot_of(runs, all, metric);
    if (spot.failed > 0) {
      failures.x.push_back(x);
      failures.low.push_back(spot.failed);
      failures.high.push_back(spot.runs);
      failures.runs.push_back(runs);
    }
    curve.x.push_back(x);
    curve.runs.push_back(runs);
    curve.y.push_back(spot.quartiles.median);
    band.low.push_back(spot.quartiles.lower);
    band.high.push_back(spot.quartiles.upper);
  }
  band.x = curve.x;
  if (!curve.x.empty()) {
    marks.push_back(std::move(band));
    marks.push_back(std::move(curve));
  }
  if (!failures.x.empty()) marks.push_back(std::move(failures));
  return marks;
}

/// Whether every method that has the axis has one value of it, and not all the same: labels then differ with the axis.
bool labels_follow(const std::vector<Places>& methods) {
  std::set<double> values;
  for (const Places& places : methods) {
    if (places.at.size() > 1) return false;
    for (const auto& [value, runs] : places.at) values.insert(value);
  }
  return values.size() > 1;
}

}  // namespace

Figure sweep_figure(std::span<const RunRecord> runs, const FigureOptions& options) {
  const std::string name = axis_of(runs, options);
  const FigureRuns all(runs, options.causal, name);
  const std::vector<Metric> metrics = all.metrics(options);
  const RunColumn& axis = find_column(all.columns, name);
  Figure figure;
  std::vector<Places> places;
  std::vector<std::vector<std::size_t>> groups;
  std::vector<double> values;
  for (const Method& method : all.methods) {
    figure.series.push_back({method.name});
    places.push_back(places_of(method, axis));
    if (!places.back().without.empty()) groups.push_back(places.back().without);
    for (const auto& [x, of_value] : places.back().at) {
      values.push_back(x);
      groups.push_back(of_value);
    }
  }
  bool some_failed = false;
  std::vector<std::vector<double>> heights;  // in each panel
  for (const Metric& metric : metrics) {
    Panel panel{{options.axis_label.empty() ? name : options.axis_label, spread_wide(values)}, {metric.header}, {}};
    if (!values.empty()) {
      const auto [first, last] = std::ranges::minmax(values);
      panel.x.ends = first < last ? std::vector{first, last} : std::vector{first};
    }
    heights.emplace_back();
    for (std::size_t m = 0; m < places.size(); ++m) {
      for (Mark& mark : draw_method(places[m], m, all, metric)) {
        some_failed = some_failed || mark.kind == Mark::Kind::failures;
        heights.back().insert(heights.back().end(), mark.y.begin(), mark.y.end());
        panel.marks.push_back(std::move(mark));
      }
    }
    figure.panels.push_back(std::move(panel));
  }
  for (Panel& panel : figure.panels) panel.y.log = any_spread_wide(heights);
  figure.columns = std::min<std::size_t>(figure.panels.size(), 2);
  figure.height_mm = 64.0 * std::ceil(static_cast<double>(figure.panels.size()) / 2.0);
  std::string what = all.pooled("Medians, and bands between quartiles", groups);
  if (some_failed) {
    what +=
        " Above: how many of the runs failed; they count as worse than all others, and quartiles that are theirs are "
        "not drawn.";
  }
  if (labels_follow(places)) {
    figure.remarks.push_back(
        fmt::format("Labels differ wherever {} does: no curve joins their points, unless they get one label.", name));
    what += " " + figure.remarks.back();
  }
  figure.caption = all.scored_caption(what, options.causal, metrics);
  return figure;
}

}  // namespace evbench
