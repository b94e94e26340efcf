#include "bench/report/report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <map>
#include <set>
#include <vector>

#include "bench/figures/figure_runs.hpp"
#include "bench/figures/run_figures.hpp"
#include "bench/report/run_data.hpp"
#include "bench/scores_by_protocol.hpp"
#include "bench/version.hpp"
#include "core/io/utc_time.hpp"
#include "core/support/error.hpp"
#include "core/support/index.hpp"
#include "core/support/parallel.hpp"
#include "eval/run_columns.hpp"
#include "eval/table_notes.hpp"
#include "eval/table_parts.hpp"

namespace evbench::report {
namespace {

/// The experiments' names, or how many there are.
std::string title_of(std::span<const RunRecord> runs) {
  std::vector<std::string> names;
  for (const RunRecord& run : runs) {
    if (std::ranges::find(names, run.experiment) == names.end()) names.push_back(run.experiment);
  }
  if (names.size() > 3) return fmt::format("{} experiments", names.size());
  return fmt::format("{}", fmt::join(names, ", "));
}

Json cell_json(const TextTable::Cell& cell) {
  Json json = {{"text", cell.text}};
  if (cell.value) json["value"] = *cell.value;
  if (!cell.detail.empty()) json["detail"] = cell.detail;
  if (cell.best) json["best"] = true;
  return json.size() == 1 ? Json(cell.text) : json;
}

Json table_json(const std::string& title, const std::string& file, const TextTable& table) {
  Json json = {
      {"title", title}, {"file", file}, {"columns", Json::array()}, {"rows", Json::array()}, {"notes", table.notes}};
  for (const TextTable::Column& column : table.columns) {
    Json one = {{"header", column.header.empty() ? "back-end" : column.header}, {"number", column.number}};
    if (!column.key.empty()) one["key"] = column.key;
    json["columns"].push_back(std::move(one));
  }
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    Json row = {{"runs", table.runs[i]}, {"cells", Json::array()}};
    for (const TextTable::Cell& cell : table.rows[i]) row["cells"].push_back(cell_json(cell));
    json["rows"].push_back(std::move(row));
  }
  return json;
}

/// Columns, but the label, in which runs differ.
std::vector<const RunColumn*> varying(const std::vector<RunColumn>& columns) {
  std::vector<const RunColumn*> result;
  for (const RunColumn& column : columns) {
    if (column.name != "label" && column.varies()) result.push_back(&column);
  }
  return result;
}

/// A summary over seeds, if they vary, and a row for each run.
Json tables(std::span<const RunRecord> runs, const std::vector<RunColumn>& columns) {
  Json result = Json::array();
  if (find_column(columns, "seed").varies()) {
    try {
      result.push_back(table_json("Over seeds", "over_seeds",
                                  text_table(runs, {.format = TableFormat::markdown, .over = {"seed"}})));
    } catch (const InputError&) {  // two runs of a row are not the same job: only the runs are listed
    }
  }
  result.push_back(table_json("Runs", "runs", text_table(runs, {.format = TableFormat::markdown})));
  return result;
}

/// Every kind of figure that these runs allow.
Json figures(std::span<const RunRecord> runs, const std::vector<RunColumn>& columns) {
  Json result = Json::array();
  const auto add = [&](const std::string& title, const std::string& file, const auto& make) {
    try {
      result.push_back({{"title", title}, {"file", file}, {"figure", to_json(make())}});
    } catch (const InputError&) {  // these runs have nothing to show in it
    }
  };
  std::vector<std::string> axes;
  for (const RunColumn* column : varying(columns)) {
    if (is_numeric_axis(*column)) axes.push_back(column->name);
  }
  for (const std::string& axis : axes) {
    add("Against " + axis, "against_" + axis, [&] { return sweep_figure(runs, {.axis = axis}); });
  }
  for (std::size_t i = 0; i < axes.size(); ++i) {
    for (std::size_t j = i + 1; j < axes.size(); ++j) {
      add(fmt::format("{} across {}", axes[i], axes[j]), fmt::format("map_{}_{}", axes[i], axes[j]),
          [&] { return map_figure(runs, {.axis = axes[i], .across = axes[j]}); });
    }
  }
  if (runs.size() > 1) {
    add("Each back-end's runs", "boxes", [&] { return box_figure(runs, {}); });
    add("Performance profile", "profile", [&] { return profile_figure(runs, {}); });
  }
  add("Times of updates", "times", [&] { return times_figure(runs, {}); });
  return result;
}

Json fact(const std::string& name, const std::string& value) { return {{"name", name}, {"value", value}}; }

/// What all of these runs have in common, or how many values there are.
Json about(std::span<const RunRecord> runs) {
  Json facts = Json::array();
  for (const auto& [name, path] :
       {std::pair{"source", "source.type"}, {"front-end", "frontend.type"}, {"back-end", "backend.type"}}) {
    std::set<std::string> values;
    for (const RunRecord& run : runs) {
      if (const std::string text = setting_text(run.settings, path); !text.empty()) values.insert(text);
    }
    if (!values.empty()) facts.push_back(fact(name, fmt::format("{}", fmt::join(values, ", "))));
  }
  std::set<std::uint64_t> seeds;
  for (const RunRecord& run : runs) {
    if (run.seed) seeds.insert(*run.seed);
  }
  if (seeds.size() == 1) facts.push_back(fact("seed", fmt::format("{}", *seeds.begin())));
  if (seeds.size() > 1) {
    facts.push_back(fact("seeds", fmt::format("{}, {} to {}", seeds.size(), *seeds.begin(), *seeds.rbegin())));
  }
  return facts;
}

Json settings_json(const std::vector<const RunColumn*>& columns, std::size_t run) {
  Json facts = Json::array();
  for (const RunColumn* column : columns) {
    if (!column->values[run].empty()) facts.push_back(fact(column->name, column->values[run]));
  }
  return facts;
}

}  // namespace

Json payload(std::span<RunRecord> runs, const std::string& protocol, const std::string& command) {
  const Budget budget(runs.size());
  const std::vector<RunColumn> columns = run_columns(runs);
  const std::vector<RunNumbers> numbers = numbers_of(runs, false);
  const std::vector<std::string> names = run_names(columns);
  Json json = {{"format", "evbench.report"}, {"version", 1},
               {"title", title_of(runs)},    {"created", utc_time(std::chrono::system_clock::now())},
               {"program", version_text()},  {"command", command},
               {"about", about(runs)},       {"protocol", collect_protocols(numbers).texts},
               {"remarks", Json::array()}};
  json["tables"] = tables(runs, columns);
  json["figures"] = figures(runs, columns);

  std::vector<Json> run_data(runs.size());
  std::vector<std::vector<std::string>> damage(runs.size());
  parallel_for(0, static_cast<int>(runs.size()),
               [&](int i) { run_data[index(i)] = run_json(runs[index(i)], protocol, budget, damage[index(i)]); });
  for (std::size_t i = 0; i < runs.size(); ++i) {
    for (const std::string& text : damage[i]) json["remarks"].push_back(fmt::format("{}: {}", names[i], text));
  }
  if (runs.size() > 5) {
    json["remarks"].push_back(
        fmt::format("Curves over time are thinned to about {} samples a run.", budget.trajectory()));
  }

  std::map<std::string, std::size_t> sequences;
  json["sequences"] = Json::array();
  json["runs"] = Json::array();
  const std::vector<const RunColumn*> differing = varying(columns);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const RunRecord& run = runs[i];
    const auto [found, is_new] = sequences.try_emplace(sequence_of(run), sequences.size());
    if (is_new) {
      const double from = run.range ? run.range->from : 0.0, to = run.range ? run.range->to : 0.0;
      const std::string name = fmt::format("{}{}", run.experiment, run.seed ? fmt::format(", seed {}", *run.seed) : "");
      json["sequences"].push_back({{"name", name}, {"from", from}, {"to", to}, {"ground_truth", nullptr}});
    }
    Json& sequence = json["sequences"][found->second];
    if (sequence["ground_truth"].is_null() && run.done) {
      sequence["ground_truth"] = ground_truth_json(run, budget);
    }
    run_data[i]["name"] = names[i];
    run_data[i]["sequence"] = found->second;
    run_data[i]["settings"] = settings_json(differing, i);
    json["runs"].push_back(std::move(run_data[i]));
  }
  return json;
}

std::string page(const Json& payload) {
  std::string data = payload.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string escaped;  // no tag may begin within the data
  escaped.reserve(data.size());
  for (const char c : data) {
    if (c == '<') {
      escaped += "\\u003c";
    } else {
      escaped.push_back(c);
    }
  }
  std::string text(page_template());
  constexpr std::string_view kPlace = "@DATA@";
  return text.replace(text.find(kPlace), kPlace.size(), escaped);
}

}  // namespace evbench::report
