#include "eval/table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "core/support/error.hpp"
#include "core/support/index.hpp"
#include "eval/table_parts.hpp"

namespace evbench {
namespace {

bool shown_by_default(const Metric& metric, const TableOptions& options) {
  if (options.format == TableFormat::long_csv) return true;
  if (options.format == TableFormat::latex) return metric.shown.print;
  return options.over.empty() ? metric.shown.screen : metric.shown.summary;
}

constexpr const char* kTextColumns[] = {"key", "folder", "status"};

/// The columns to show: the requested ones, else the default ones that at least one run has.
std::vector<Metric> choose_metrics(const std::vector<RunNumbers>& runs, const TableOptions& options) {
  std::vector<std::string> keys;
  for (const std::string& key : options.metrics) {
    if (std::ranges::find(kTextColumns, key) == std::end(kTextColumns)) {
      keys.push_back(key);
    } else if (!options.over.empty()) {
      throw InputError(fmt::format("\"{}\" is of one run, and a row of --over is of several; expected a number", key));
    }
  }
  std::vector<Metric> metrics = metrics_of(keys, runs);
  const auto waited = [](const RunNumbers& run) { return run.run().times && run.run().times->waiting > 0.0; };
  const bool all_in_one_thread = std::ranges::none_of(runs, waited);
  const bool row_a_run = options.format == TableFormat::csv && options.over.empty();
  for (const Metric& metric : known_metrics()) {
    if (metric.key == "times.waiting_s" && all_in_one_thread) continue;
    const bool asked = std::ranges::find(options.metrics, metric.key) != options.metrics.end();
    const bool usual = options.metrics.empty() && shown_by_default(metric, options);
    const bool of_protocol = metric.key == "pairs" || metric.key == "coverage" || metric.key == "scale";
    if (!asked && (usual || (row_a_run && of_protocol)) && any_has(runs, metric.key)) metrics.push_back(metric);
  }
  return metrics;
}

}  // namespace

int decimals_of(const std::vector<std::optional<double>>& values) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const auto& value : values) {
    if (value && *value != 0.0) smallest = std::min(smallest, std::abs(*value));
  }
  if (!std::isfinite(smallest)) return 1;
  return std::clamp(2 - static_cast<int>(std::floor(std::log10(smallest))), 1, 6);
}

void add_column(TextTable& table, const std::string& header, bool number, std::vector<TextTable::Cell> cells,
                std::size_t rank, const std::string& key) {
  table.columns.push_back({header, number, rank, key});
  for (std::size_t i = 0; i < cells.size(); ++i) table.rows[i].push_back(std::move(cells[i]));
}

std::string header_of(const Metric& metric, TableFormat format) {
  return format == TableFormat::latex && !metric.brief.empty() ? metric.brief : metric.header;
}

std::size_t rank_of(const Metric& metric, const TableOptions& options) {
  constexpr std::array kFirst = {"ate.trans_m.rmse", "rpe.trans_m.rmse", "coverage",
                                 "realtime_factor",  "ate.rot_deg.rmse", "rpe.rot_deg.rmse"};
  if (!options.metrics.empty()) return 0;
  const auto first = std::ranges::find(kFirst, metric.key);
  if (first != kFirst.end()) return index(first - kFirst.begin());
  const auto known = std::ranges::find(known_metrics(), metric.key, &Metric::key);
  return kFirst.size() + index(known - known_metrics().begin());
}

bool asks_for(const TableOptions& options, const char* column) {
  return std::ranges::find(options.metrics, column) != options.metrics.end();
}

std::vector<std::string> run_names(const std::vector<RunColumn>& columns) {
  const RunColumn& labels = find_column(columns, "label");
  std::map<std::string, int> count;
  for (const std::string& label : labels.values) ++count[label];
  std::vector<std::string> names;
  for (std::size_t i = 0; i < labels.values.size(); ++i) {
    std::string rest;
    for (const RunColumn& column : columns) {
      if (&column == &labels || count[labels.values[i]] == 1 || !column.varies() || column.values[i].empty()) continue;
      rest += fmt::format("{}{} {}", rest.empty() ? "" : ", ", column.name, column.values[i]);
    }
    names.push_back(rest.empty() ? labels.values[i] : fmt::format("{} ({})", labels.values[i], rest));
  }
  return names;
}

std::vector<std::string> distinct_experiments(const TableRuns& runs) {
  std::vector<std::string> names;
  for (const RunNumbers& run : runs.runs) {
    const std::string& name = run.run().experiment;
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  }
  return names;
}

bool any_of_common_time(const std::vector<std::string>& metrics) {
  return std::ranges::any_of(metrics, [](const std::string& key) { return key.starts_with("common."); });
}

bool shows_common_time(const TableOptions& options, std::size_t runs) {
  if (!options.metrics.empty()) return any_of_common_time(options.metrics);
  return options.format != TableFormat::latex && options.format != TableFormat::long_csv && runs <= kCommonTimeRuns;
}

std::string list_metrics(std::span<const RunRecord> runs) {
  std::string text;
  for (const std::string& key : keys_of(numbers_of(runs, false))) {
    const Metric metric = metric_of(key);
    text += metric.header == key ? key + "\n" : fmt::format("{:<34} {}\n", key, metric.header);
  }
  return text;
}

namespace {

/// Absolute paths without their common folder, by the full path.
std::map<std::string, std::string> without_common_folder(const std::set<std::string>& texts) {
  std::vector<std::string> paths;
  std::ranges::copy_if(texts, std::back_inserter(paths), [](const std::string& text) { return text.starts_with('/'); });
  std::map<std::string, std::string> shorter;
  if (paths.empty()) return shorter;
  std::string common = paths.front().substr(0, paths.front().rfind('/') + 1);
  for (const std::string& path : paths) {
    while (!path.starts_with(common)) common.erase(common.rfind('/', common.size() - 2) + 1);
  }
  for (const std::string& path : paths) shorter[path] = path.substr(common.size());
  return shorter;
}

/// For print: shortens labels and experiments that are paths, as of compared files, to the parts in which they differ.
std::vector<RunRecord> without_folders(std::span<const RunRecord> runs) {
  std::set<std::string> labels, experiments;
  for (const RunRecord& run : runs) {
    labels.insert(run.label);
    experiments.insert(run.experiment);
  }
  const auto shorter_labels = without_common_folder(labels), shorter_experiments = without_common_folder(experiments);
  const auto shorten = [](std::string& text, const std::map<std::string, std::string>& shorter) {
    if (const auto found = shorter.find(text); found != shorter.end()) text = found->second;
  };
  std::vector<RunRecord> result(runs.begin(), runs.end());
  for (RunRecord& run : result) {
    shorten(run.label, shorter_labels);
    shorten(run.experiment, shorter_experiments);
  }
  return result;
}

/// Options with `over` in place of `by`.
TableOptions over_what_varies(TableOptions options, const std::vector<RunColumn>& columns) {
  if (options.by.empty()) {
    if (options.success == 0.0 || !options.over.empty()) return options;
    throw InputError("--success is of several runs in a row; expected --by or --over");
  }
  if (!options.over.empty()) throw InputError("--by and --over say the same in two ways; expected one of them");
  for (const std::string& name : options.by) find_column(columns, name);
  for (const RunColumn& column : columns) {
    const bool named = column.name == "label" || std::ranges::find(options.by, column.name) != options.by.end();
    if (!named && column.varies()) options.over.push_back(column.name);
  }
  if (options.over.empty()) {
    throw InputError(
        fmt::format("runs differ in nothing but {}; expected fewer columns for --by, or none: a row per run",
                    fmt::join(options.by, ", ")));
  }
  if (options.success == 0.0) options.success = 1.0;
  return options;
}

}  // namespace

namespace {

TableRuns collect(std::span<const RunRecord> runs, const TableOptions& options) {
  TableRuns all;
  all.runs = numbers_of(runs, options.causal);
  all.protocols = collect_protocols(all.runs);
  if (all.protocols.texts.empty() && options.causal) {
    throw InputError(fmt::format("none of the {} runs has causal scores", runs.size()));
  }
  all.metrics = choose_metrics(all.runs, options);
  all.columns = run_columns(runs);
  return all;
}

TextTable cells_and_notes(const TableRuns& all, std::span<const RunRecord> runs, const TableOptions& options) {
  TextTable table = options.over.empty() ? run_table(all, options) : summary_table(all, options);
  table.experiments = distinct_experiments(all);
  if (table.experiments.size() == 1 && options.format != TableFormat::latex) {
    table.notes.insert(table.notes.begin(), fmt::format("Experiment: {}.", runs[0].experiment));
  }
  if (options.metrics.empty() && runs.size() > kCommonTimeRuns && !shows_common_time(options, runs.size())) {
    table.notes.push_back(
        fmt::format("Of more than {} runs errors over common time are shown only by request: --metrics "
                    "common.ate.trans_m.rmse,...",
                    kCommonTimeRuns));
  }
  return table;
}

void require_runs(std::span<const RunRecord> runs) {
  if (runs.empty()) throw InputError("there is no run to make a table of");
}

}  // namespace

std::string make_table(std::span<const RunRecord> found, const TableOptions& requested) {
  require_runs(found);
  const TableOptions options = over_what_varies(requested, run_columns(found));
  const bool print = options.format == TableFormat::latex;
  const std::vector<RunRecord> shortened = print ? without_folders(found) : std::vector<RunRecord>();
  const std::span<const RunRecord> runs = print ? shortened : found;
  const TableRuns all = collect(runs, options);
  if (options.format == TableFormat::long_csv) return long_table(all, options);
  return format_table(cells_and_notes(all, runs, options), options.format, options.layout);
}

TextTable text_table(std::span<const RunRecord> runs, const TableOptions& requested) {
  require_runs(runs);
  const TableOptions options = over_what_varies(requested, run_columns(runs));
  return cells_and_notes(collect(runs, options), runs, options);
}

}  // namespace evbench
