#include "eval/run_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <unordered_map>
#include <utility>

#include "core/support/error.hpp"
#include "core/support/json.hpp"
#include "core/support/nearest.hpp"

namespace evbench {
namespace {

/// Paths of the settings that differ between two runs, in their order.
void add_differences(const RunSettings& a, const RunSettings& b, std::vector<std::string>& paths) {
  const auto add = [&](const std::string& path) {
    if (std::ranges::find(paths, path) == paths.end()) paths.push_back(path);
  };
  if (std::ranges::equal(a, b, {}, &RunSettings::value_type::first, &RunSettings::value_type::first)) {
    for (std::size_t i = 0; i < a.size(); ++i) {
      if (a[i].second != b[i].second) add(a[i].first);
    }
    return;
  }
  for (const auto& [path, value] : a) {  // other plugins: other options
    const Json* theirs = find_setting(b, path);
    if (theirs == nullptr || *theirs != value) add(path);
  }
  for (const auto& [path, value] : b) {
    if (find_setting(a, path) == nullptr) add(path);
  }
}

/// Settings in which runs of one experiment and label differ. Runs of a sweep are distinguished by its axes instead.
std::vector<std::string> varying_settings(std::span<const RunRecord> runs) {
  std::map<std::pair<std::string, std::string>, const RunRecord*> firsts;
  std::vector<std::string> paths;
  for (const RunRecord& run : runs) {
    if (!run.axes.empty() || run.settings.empty()) continue;
    const RunRecord* first = firsts.try_emplace({run.experiment, run.label}, &run).first->second;
    add_differences(first->settings, run.settings, paths);
  }
  return paths;
}

std::vector<std::string> axis_names(std::span<const RunRecord> runs) {
  std::vector<std::string> names;
  for (const RunRecord& run : runs) {
    for (const auto& [name, value] : run.axes) {
      if (name != "seed" && std::ranges::find(names, name) == names.end()) names.push_back(name);
    }
  }
  return names;
}

std::string axis_text(const RunRecord& run, const std::string& name) {
  const auto found = std::ranges::find(run.axes, name, &RunAxes::value_type::first);
  return found == run.axes.end() ? "" : found->second;
}

std::string settings_below(const std::string& part, const RunSettings& settings) {
  std::string text;
  for (const auto& [path, value] : settings) {
    if (path.starts_with(part)) text += path + '=' + dump_json(value) + '\n';
  }
  return text;
}

template <class Text>
RunColumn column(const std::string& name, std::span<const RunRecord> runs, const Text& text) {
  RunColumn result{name, {}};
  for (const RunRecord& run : runs) result.values.push_back(text(run));
  return result;
}

}  // namespace

bool RunColumn::varies() const {
  return std::ranges::any_of(values, [&](const std::string& value) { return value != values.front(); });
}

std::vector<RunColumn> run_columns(std::span<const RunRecord> runs) {
  std::vector<RunColumn> columns;
  columns.push_back(column("experiment", runs, [](const RunRecord& run) { return run.experiment; }));
  columns.push_back(column("label", runs, [](const RunRecord& run) { return run.label; }));
  for (const std::string& name : axis_names(runs)) {
    columns.push_back(column(name, runs, [&](const RunRecord& run) { return axis_text(run, name); }));
  }
  for (const std::string& path : varying_settings(runs)) {
    const auto text = [&](const RunRecord& run) {
      return run.axes.empty() ? setting_text(run.settings, path) : std::string();
    };
    columns.push_back(column(path, runs, text));
  }
  const auto seed = [](const RunRecord& run) { return run.seed ? fmt::format("{}", *run.seed) : std::string(); };
  columns.push_back(column("seed", runs, seed));
  return columns;
}

const RunColumn& find_column(const std::vector<RunColumn>& columns, std::string_view name) {
  const auto found = std::ranges::find(columns, name, &RunColumn::name);
  if (found != columns.end()) return *found;
  std::vector<std::string> names;
  for (const RunColumn& column : columns) names.push_back(column.name);
  throw InputError(fmt::format("runs do not differ in \"{}\"{}", name, suggestion(std::string(name), names)));
}

std::vector<std::vector<std::size_t>> equal_runs(const std::vector<const RunColumn*>& columns, std::size_t runs) {
  std::vector<std::vector<std::size_t>> groups;
  std::unordered_map<std::string, std::size_t> known;
  for (std::size_t i = 0; i < runs; ++i) {
    std::string name;
    for (const RunColumn* column : columns) (name += column->values[i]) += '\0';
    const auto [found, is_new] = known.try_emplace(std::move(name), groups.size());
    if (is_new) groups.emplace_back();
    groups[found->second].push_back(i);
  }
  return groups;
}

std::string sequence_of(const RunRecord& run) {
  if (run.settings.empty()) return "folder=" + run.folder;  // unknown: a sequence of its own
  return (run.seed ? fmt::format("seed={}\n", *run.seed) : "") + settings_below("source.", run.settings);
}

std::string data_of(const RunRecord& run) { return sequence_of(run) + settings_below("frontend.", run.settings); }

}  // namespace evbench
