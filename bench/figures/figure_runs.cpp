#include "bench/figures/figure_runs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include "core/support/error.hpp"
#include "eval/paired_comparison.hpp"
#include "eval/protocol.hpp"

namespace evbench {

FigureRuns::FigureRuns(std::span<const RunRecord> records, bool causal, const std::string& without,
                       const std::string& apart)
    : runs(numbers_of(records, causal)),
      columns(columns_with(records, without)),
      methods(methods_of(runs, columns, number_data(runs), without, apart)) {
  if (methods.empty()) throw InputError("none of these runs was done yet; expected some to draw");
}

std::vector<Metric> FigureRuns::metrics(const FigureOptions& options) const {
  if (!options.metrics.empty()) return metrics_of(options.metrics, runs);
  return metrics_of({"ate.trans_m.rmse", "rpe.trans_m.rmse"}, runs);
}

std::string FigureRuns::pooled(const std::string& what, const std::vector<std::vector<std::size_t>>& groups) const {
  std::set<std::size_t> sizes;
  for (const std::vector<std::size_t>& group : groups) sizes.insert(group.size());
  if (*sizes.rbegin() == 1) return "Each point is one run.";
  std::vector<std::string> names;
  for (const RunColumn& column : columns) {
    const auto differs = [&](const std::vector<std::size_t>& group) {
      return std::ranges::any_of(group,
                                 [&](std::size_t i) { return column.values[i] != column.values[group.front()]; });
    };
    if (std::ranges::any_of(groups, differs)) names.push_back(column.name);
  }
  const std::string fewest = sizes.size() > 1 ? fmt::format("{} to ", *sizes.begin()) : "";
  return fmt::format("{}, of {}{} runs each{}.", what, fewest, *sizes.rbegin(),
                     names.empty() ? "" : fmt::format(" ({})", fmt::join(names, ", ")));
}

std::string FigureRuns::caption(const std::string& what) const {
  const std::vector<std::string>& names = find_column(columns, "experiment").values;
  const std::set<std::string> experiments(names.begin(), names.end());
  return fmt::format("{}. {}", fmt::join(experiments, ", "), what);
}

std::string FigureRuns::scored_caption(const std::string& what, bool causal, const std::vector<Metric>& metrics) const {
  const auto any = [&](const char* part) {
    return std::ranges::any_of(metrics,
                               [&](const Metric& metric) { return metric.key.find(part) != std::string::npos; });
  };
  const auto is_measured = [](const Metric& metric) {
    const std::string& key = metric.key;
    return key.starts_with("times.") || key == "runtime_s" || key == "realtime_factor" || key == "peak_rss_mib";
  };
  if (!metrics.empty() && std::ranges::all_of(metrics, is_measured)) return caption(what);
  const ProtocolParts parts{any("rpe."), any("segments."), any("equal_latency.")};
  std::string text = caption(what) + (causal ? " Causal: each pose as estimated at the time it was made."
                                             : " Final: the trajectory as estimated after the whole sequence.");
  std::vector<std::string> protocols;
  for (const RunNumbers& run : runs) {
    if (run.scores().is_null()) continue;
    std::string one = protocol(run.scores(), run.run().folder + "/metrics.json", parts);
    if (std::ranges::find(protocols, one) == protocols.end()) protocols.push_back(std::move(one));
  }
  for (const std::string& one : protocols) text += fmt::format(" {}.", one);
  return text;
}

std::optional<double> number_in(const std::string& text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

bool is_numeric_axis(const RunColumn& column) {
  const bool names = column.name == "experiment" || column.name == "label" || column.name == "seed";
  return !names && column.varies() &&
         std::ranges::all_of(column.values, [](const std::string& value) { return value.empty() || number_in(value); });
}

void check_numbers(const RunColumn& column) {
  for (const std::string& value : column.values) {
    if (value.empty() || number_in(value)) continue;
    throw InputError(fmt::format("the axis \"{}\" has the value \"{}\"; expected numbers", column.name, value));
  }
}

bool spread_wide(const std::vector<double>& values) {
  double low = std::numeric_limits<double>::infinity(), high = 0.0;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    if (value <= 0.0) return false;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  return high > 4.0 * low;
}

bool any_spread_wide(const std::vector<std::vector<double>>& panels) {
  const auto is_positive = [](double value) { return !std::isfinite(value) || value > 0.0; };
  return std::ranges::any_of(panels, spread_wide) &&
         std::ranges::all_of(
             panels, [&](const std::vector<double>& values) { return std::ranges::all_of(values, is_positive); });
}

std::vector<RunColumn> columns_with(std::span<const RunRecord> runs, const std::string& axis) {
  std::vector<RunColumn> columns = run_columns(runs);
  const bool has = std::ranges::find(columns, axis, &RunColumn::name) != columns.end();
  RunColumn column{axis, {}};
  for (const RunRecord& run : runs) column.values.push_back(setting_text(run.settings, axis));
  if (!has && column.varies()) columns.push_back(std::move(column));
  return columns;
}

}  // namespace evbench
