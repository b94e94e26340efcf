#include "bench/published_benchmark.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "bench/scores_by_protocol.hpp"
#include "core/support/error.hpp"
#include "core/support/index.hpp"
#include "core/support/nearest.hpp"
#include "eval/protocols.hpp"
#include "eval/quantile.hpp"
#include "eval/run_numbers.hpp"
#include "eval/table_text.hpp"

namespace evbench {
namespace {

/// Runs of one experiment and label.
struct Ours {
  std::string name, inputs, time;
  std::vector<double> values, covered;
  std::size_t unscored = 0;  ///< lost, failed, or without poses to align on
};

/// What the tracks of a run are from.
std::string inputs_of(const RunRecord& run) {
  const std::string frontend = setting_text(run.settings, "frontend.type");
  return frontend == "recorded" ? "recorded tracks" : "events (" + frontend + ")";
}

std::string time_of(const RunRecord& run) {
  const bool known = run.range && std::isfinite(run.range->from) && std::isfinite(run.range->to);
  return known ? fmt::format("{:.4g} to {:.4g}", run.range->from, run.range->to) : "";
}

std::vector<Ours> group(const std::vector<RunRecord>& runs, const std::string& metric) {
  const bool several =
      std::ranges::any_of(runs, [&](const RunRecord& run) { return run.experiment != runs.front().experiment; });
  std::vector<Ours> groups;
  for (const RunRecord& run : runs) {
    const std::string name = several ? fmt::format("{}: {}", run.experiment, run.label) : run.label;
    auto found = std::ranges::find(groups, name, &Ours::name);
    if (found == groups.end()) found = groups.insert(groups.end(), {name, inputs_of(run), time_of(run), {}, {}});
    const RunNumbers numbers(run, false);
    const auto value = numbers.at(metric);
    if (!run.competes() || !value) {
      ++found->unscored;
      continue;
    }
    found->values.push_back(*value);
    found->covered.push_back(numbers.at("coverage").value_or(0.0));
  }
  return groups;
}

}  // namespace

PublishedBenchmark read_published_benchmark(const RecordReader& json) {
  PublishedBenchmark result{json.text("dataset"), json.text("metric"), {}, {}};
  const auto is_text = [](const Json& value) { return value.is_string(); };
  const Json& names = json.at("sequences");
  if (!names.is_array() || !std::ranges::all_of(names, is_text)) json.fail("sequences", "a list of names");
  result.sequences = names.get<std::vector<std::string>>();
  for (const RecordReader& row : json.list("rows")) {
    const Json& values = row.at("values");
    const auto is_number = [](const Json& value) { return value.is_number(); };
    if (!values.is_array() || values.size() != names.size() || !std::ranges::all_of(values, is_number)) {
      row.fail("values", "a number for each of the sequences");
    }
    result.rows.push_back({row.text("system"), row.text("inputs"), row.text("protocol"), row.text("paper"),
                           values.get<std::vector<double>>()});
    const std::vector<std::string> known = protocol_choices();
    if (std::ranges::find(known, result.rows.back().protocol) == known.end()) {
      row.fail("protocol", "the name of a protocol (evbench list protocols)");
    }
  }
  return result;
}

std::string sequence_in(const PublishedBenchmark& benchmark, const RunRecord& run) {
  for (const char* setting : {"source.dataset", "source.folder"}) {
    const Json* const value = find_setting(run.settings, setting);
    if (value == nullptr || !value->is_string()) continue;
    const auto path = value->get<std::string>();
    const std::string name = path.substr(path.rfind('/') + 1);
    if (std::ranges::find(benchmark.sequences, name) != benchmark.sequences.end()) return name;
  }
  return "";
}

std::string published_sequence_table(const PublishedBenchmark& benchmark, const std::string& sequence,
                                     std::vector<RunRecord> runs, TableFormat format, const TableLayout& layout) {
  const auto place = std::ranges::find(benchmark.sequences, sequence);
  if (place == benchmark.sequences.end()) {
    throw InputError(
        fmt::format("there are no published numbers of \"{}\"{}", sequence, suggestion(sequence, benchmark.sequences)));
  }
  std::erase_if(runs, [&](const RunRecord& run) { return !run.done || sequence_in(benchmark, run) != sequence; });
  if (runs.empty()) {
    throw InputError(
        fmt::format("none of these runs is of {}; expected some whose source.dataset or source.folder ends "
                    "with that name",
                    sequence));
  }
  const auto column = static_cast<std::size_t>(place - benchmark.sequences.begin());
  const Metric metric = metric_of(benchmark.metric);
  const bool csv = format == TableFormat::csv;
  TextTable table;
  table.columns = {{"protocol", false}, {"system", false},
                   {"inputs", false},   {csv ? metric.key : metric.header, true},
                   {"time [s]", false}, {csv ? "coverage" : "covered [%]", true},
                   {"scored", true},    {"paper", false}};
  table.experiments = {fmt::format("{}: published and here", sequence)};
  std::vector<std::string> protocols;
  for (const PublishedBenchmark::Row& row : benchmark.rows) {
    if (std::ranges::find(protocols, row.protocol) == protocols.end()) protocols.push_back(row.protocol);
  }
  for (const std::string& protocol : protocols) {
    score_by_protocol(runs, protocol);
    for (const Ours& ours : group(runs, benchmark.metric)) {
      const std::size_t all = ours.values.size() + ours.unscored;
      const auto median = [&](const std::vector<double>& values, double factor, int digits) {
        if (values.empty()) return std::string(csv ? "" : "-");
        const double value = factor * quantile_of(values, 0.5);
        return csv ? fmt::format("{}", value) : fmt::format("{:.{}f}", value, digits);
      };
      table.rows.push_back({{protocol},
                            {ours.name},
                            {ours.inputs},
                            {median(ours.values, 1.0, 2)},
                            {ours.time},
                            {median(ours.covered, csv ? 1.0 : 100.0, 0)},
                            {fmt::format("{} of {}", ours.values.size(), all)},
                            {"here"}});
    }
    for (const PublishedBenchmark::Row& row : benchmark.rows) {
      if (row.protocol != protocol) continue;
      const double value = row.values[column];
      table.rows.push_back({{protocol},
                            {row.system},
                            {row.inputs},
                            {csv ? fmt::format("{}", value) : fmt::format("{:.2f}", value)},
                            {csv ? "" : "all"},
                            {csv ? "" : "-"},
                            {csv ? "" : "-"},
                            {row.paper}});
    }
  }
  table.notes = {
      fmt::format("{}, {}; published numbers as printed, ours the median over runs. Scored: "
                  "runs that are neither lost nor failed and have poses to align on.",
                  benchmark.dataset, sequence),
      "Compare only rows of one protocol (evbench list protocols) and the same inputs: an IMU gives the scale, which a "
      "camera alone takes from the alignment only in devo and deio, and frames and learnt networks are other inputs "
      "than events alone."};
  return format_table(table, format, layout);
}

}  // namespace evbench
