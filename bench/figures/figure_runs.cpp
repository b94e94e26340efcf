#include "bench/figures/figure_runs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include "core/support/error.hpp"

namespace evbench {

FigureRuns::FigureRuns(std::span<const RunRecord> records, bool online, const std::string& without)
    : runs(numbers_of(records, online)), columns(run_columns(records)), methods(methods_of(runs, columns, without)) {
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

std::string FigureRuns::scored_caption(const std::string& what, bool online) const {
  std::string text = caption(what) + (online ? " Online: each pose as estimated at the time it was made."
                                             : " Final: the trajectory as estimated after the whole sequence.");
  for (const std::string& protocol : collect_protocols(runs).texts) text += fmt::format(" {}.", protocol);
  return text;
}

std::optional<double> number_in(const std::string& text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
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

}  // namespace evbench
