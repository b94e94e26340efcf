#include "bench/published.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>

#include "core/support/error.hpp"
#include "eval/json_file.hpp"
#include "eval/protocol.hpp"
#include "eval/record_reader.hpp"
#include "eval/run_numbers.hpp"
#include "eval/table_text.hpp"

namespace evbench {
namespace fs = std::filesystem;
namespace {

constexpr const char* kConfigs = "configs/paper";

PublishedRow read_row(const RecordReader& json) {
  PublishedRow row{json.text("label"), json.text_or("over", ""), {}};
  if (!json.at("values").is_object()) json.fail("values", "numbers by metric");
  const RecordReader values(json.at("values"), json.place() + ".values");
  for (const auto& [key, value] : json.at("values").items()) {
    if (row.over.empty()) {
      row.values.push_back({key, values.number(key.c_str()), std::nullopt});
      continue;
    }
    const bool two = value.is_array() && value.size() == 2 && value[0].is_number() && value[1].is_number();
    if (!two || value[0].get<double>() <= 0.0 || value[1].get<double>() <= 0.0) {
      values.fail(key.c_str(), "two numbers above 0, of \"label\" and of \"over\"");
    }
    row.values.push_back({key, value[0].get<double>(), value[1].get<double>()});
  }
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

std::string text_of(const std::optional<double>& value, int digits, bool csv) {
  if (!value) return csv ? "" : "-";
  return csv ? fmt::format("{}", *value) : fmt::format("{:.{}g}", *value, digits);
}

std::optional<double> number_of(const RunRecord* run, const std::string& metric) {
  return run != nullptr && run->competes() ? RunNumbers(*run, false).at(metric) : std::nullopt;
}

/// "yes" if the ratio is on the same side of 1 as the paper's.
std::string holds(const std::optional<double>& here, double paper, bool csv) {
  if (!here) return csv ? "" : "-";
  return (*here < 1.0) == (paper < 1.0) ? "yes" : "no";
}

void add_row(TextTable& table, const std::string& experiment, const PublishedRow& row, const PublishedValue& value,
             const RunRecord* own, const RunRecord* base, bool csv) {
  const Metric metric = metric_of(value.metric);
  std::optional<double> here = number_of(own, value.metric);
  double paper = value.own;
  if (value.base) {
    const std::optional<double> other = number_of(base, value.metric);
    here = here && other && *other > 0.0 ? std::optional(*here / *other) : std::nullopt;
    paper /= *value.base;
  }
  const int digits = value.base ? 2 : 4;
  table.rows.push_back({{experiment},
                        {row.label},
                        {row.over},
                        {csv          ? metric.key
                         : value.base ? metric.header.substr(0, metric.header.find(" ["))
                                      : metric.header},
                        {text_of(here, digits, csv)},
                        {text_of(paper, digits, csv)},
                        {value.base ? holds(here, paper, csv)
                         : csv      ? ""
                                    : "-"}});
}

}  // namespace

std::string find_paper_configs(const std::string& asked) {
  std::error_code error;
  if (!asked.empty()) {
    if (fs::is_directory(asked, error)) return asked;
    throw InputError(fmt::format("{}: there is no such folder; expected one with configs, and published.json", asked));
  }
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  const std::string installed = program.parent_path().parent_path() / "share/evbench" / kConfigs;
  for (const std::string& folder : {std::string(kConfigs), installed}) {
    if (fs::is_directory(folder, error)) return folder;
  }
  throw InputError(
      fmt::format("{}: there is no such folder here, and no {}. The paper's configs are in evbench's repository: "
                  "expected its folder as the working folder, or for evbench reproduce --configs REPOSITORY/{}",
                  kConfigs, installed, kConfigs));
}

Published read_published(const std::string& path) {
  const Json file = read_json_file(path);
  const RecordReader json(file, path);
  Published published{json.text("paper"), {}, {}};
  if (!json.at("benchmark").is_null()) {
    published.benchmark = read_published_benchmark({json.at("benchmark"), path + ": benchmark"});
  }
  for (const RecordReader& result : json.list("results")) published.results.push_back(read_result(result));
  return published;
}

std::string published_table(const Published& published, std::span<const RunRecord> runs, TableFormat format,
                            const TableLayout& layout) {
  const bool csv = format == TableFormat::csv;
  TextTable table;
  table.columns = {{"experiment", false}, {csv ? "label" : "", false},
                   {"over", false},       {"metric", false},
                   {"here", true},        {"paper", true},
                   {"holds", false}};
  table.experiments = {"Here and in the paper"};
  table.notes.push_back(fmt::format("Paper: {}.", published.paper));
  table.notes.emplace_back(
      "A row of one back-end over another has the ratios of their errors, here and in the paper, because metres of "
      "another recording, at another scale, can't be compared. A claim holds if both ratios are on the same side of "
      "1.");
  std::vector<std::string> unpublished;
  for (const RunRecord& run : runs) {
    const bool is_published =
        std::ranges::find(published.results, run.experiment, &PublishedResult::config) != published.results.end();
    if (!is_published && std::ranges::find(unpublished, run.experiment) == unpublished.end())
      unpublished.push_back(run.experiment);
  }
  for (const PublishedResult& result : published.results) {
    const auto ours = std::ranges::find(runs, result.config, &RunRecord::experiment);
    if (ours == runs.end()) continue;
    for (const PublishedRow& row : result.rows) {
      const RunRecord* own = find_run(runs, result.config, row.label);
      const RunRecord* base = find_run(runs, result.config, row.over);
      for (const PublishedValue& value : row.values) add_row(table, result.config, row, value, own, base, csv);
    }
    const std::string here =
        ours->final_scores.is_null() ? "no scores" : protocol(ours->final_scores, ours->folder + "/metrics.json");
    table.notes.push_back(fmt::format("{} ({}). Here: {}. Paper: {}. {}", result.config, result.what, here,
                                      result.protocol, result.not_equal));
  }
  for (const std::string& name : unpublished) table.notes.push_back(fmt::format("{}: no published numbers.", name));
  return format_table(table, format, layout);
}

}  // namespace evbench
