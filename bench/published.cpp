#include "bench/published.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "core/support/error.hpp"
#include "eval/json_file.hpp"
#include "eval/protocol.hpp"
#include "eval/record_reader.hpp"
#include "eval/run_numbers.hpp"
#include "eval/table_text.hpp"

namespace evbench {
namespace {

PublishedRow read_row(const RecordReader& json) {
  PublishedRow row{json.text("label"), {}};
  if (!json.at("values").is_object()) json.fail("values", "numbers by metric");
  const RecordReader values(json.at("values"), json.place() + ".values");
  for (const auto& [key, value] : json.at("values").items()) row.values.emplace_back(key, values.number(key.c_str()));
  return row;
}

PublishedResult read_result(const RecordReader& json) {
  PublishedResult result{
      json.text("config"), json.text("what"), json.text("protocol"), json.text_or("not_equal", ""), {}};
  for (const RecordReader& row : json.list("rows")) result.rows.push_back(read_row(row));
  return result;
}

const RunRecord* find_run(std::span<const RunRecord> runs, const std::string& experiment, const std::string& label) {
  const auto found = std::ranges::find_if(
      runs, [&](const RunRecord& run) { return run.experiment == experiment && run.label == label; });
  return found == runs.end() ? nullptr : &*found;
}

std::string number_text(const std::optional<double>& value, bool csv) {
  if (!value) return csv ? "" : "-";
  return csv ? fmt::format("{}", *value) : fmt::format("{:.4g}", *value);
}

void add_row(TextTable& table, const PublishedResult& result, const std::string& label, const Metric& metric,
             const RunRecord* run, double published, bool csv) {
  const std::optional<double> ours = run == nullptr ? std::nullopt : RunNumbers(*run, false).at(metric.key);
  const std::optional<double> ratio = ours ? std::optional(*ours / published) : std::nullopt;
  table.rows.push_back({{result.config},
                        {label},
                        {csv ? metric.key : metric.header},
                        {number_text(ours, csv)},
                        {number_text(published, csv)},
                        {number_text(ratio, csv)}});
}

}  // namespace

Published read_published(const std::string& path) {
  const Json file = read_json_file(path);
  const RecordReader json(file, path);
  Published published{json.text("paper"), {}};
  for (const RecordReader& result : json.list("results")) published.results.push_back(read_result(result));
  return published;
}

std::string published_table(const Published& published, std::span<const RunRecord> runs, TableFormat format) {
  const bool csv = format == TableFormat::csv;
  TextTable table;
  table.columns = {{"experiment", false}, {csv ? "label" : "", false}, {"metric", false}, {"here", true},
                   {"paper", true},       {"here / paper", true}};
  table.experiments = {"Here and in the paper"};
  table.notes.push_back(fmt::format("Paper: {}.", published.paper));
  std::vector<std::string> untold;
  for (const RunRecord& run : runs) {
    const bool told =
        std::ranges::find(published.results, run.experiment, &PublishedResult::config) != published.results.end();
    if (!told && std::ranges::find(untold, run.experiment) == untold.end()) untold.push_back(run.experiment);
  }
  for (const PublishedResult& result : published.results) {
    const auto ours = std::ranges::find(runs, result.config, &RunRecord::experiment);
    if (ours == runs.end()) continue;
    for (const PublishedRow& row : result.rows) {
      const RunRecord* run = find_run(runs, result.config, row.label);
      for (const auto& [key, value] : row.values) add_row(table, result, row.label, metric_of(key), run, value, csv);
    }
    const std::string here =
        ours->final_scores.is_null() ? "no scores" : protocol(ours->final_scores, ours->folder + "/metrics.json");
    table.notes.push_back(fmt::format("{} ({}). Here: {}. Paper: {}. {}", result.config, result.what, here,
                                      result.protocol, result.not_equal));
  }
  for (const std::string& name : untold) table.notes.push_back(fmt::format("{}: the paper has no number of it.", name));
  return format_table(table, format);
}

}  // namespace evbench
