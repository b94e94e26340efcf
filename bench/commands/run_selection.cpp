#include "bench/commands/run_selection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "bench/commands/failures.hpp"
#include "core/support/error.hpp"
#include "core/support/nearest.hpp"
#include "eval/find_runs.hpp"
#include "eval/newest_jobs.hpp"
#include "eval/run_columns.hpp"

namespace evbench {
namespace {

/// Each run's value of a column, setting or "key".
std::vector<std::string> values_of(const std::string& name, const std::vector<RunColumn>& columns,
                                   const std::vector<RunRecord>& runs) {
  const bool is_column = std::ranges::find(columns, name, &RunColumn::name) != columns.end();
  const auto has = [&](const RunRecord& run) { return find_setting(run.settings, name) != nullptr; };
  if (is_column || (name != "key" && std::ranges::none_of(runs, has))) return find_column(columns, name).values;
  std::vector<std::string> values;
  for (const RunRecord& run : runs) values.push_back(name == "key" ? run.key : setting_text(run.settings, name));
  return values;
}

}  // namespace

void add_folders(CLI::App& command, std::vector<std::string>& folders) {
  command.add_option("folders", folders, "Folders of runs, searched with all folders below")
      ->required()
      ->type_name("DIR");
}

void use_runs(const std::vector<std::string>& folders, const std::function<void(std::vector<RunRecord>&)>& use) {
  std::vector<std::string> unreadable;
  std::vector<RunRecord> runs = find_runs(folders, &unreadable);
  if (!runs.empty()) use(runs);
  throw_together(unreadable);
}

CLI::Validator has_equals(const std::string& shown) {
  return CLI::Validator(
      [shown](const std::string& value) {
        return value.find('=') == std::string::npos ? fmt::format("{}: expected {}", value, shown) : std::string();
      },
      "");
}

void add_run_selection(CLI::App& command, RunSelection& selection) {
  add_folders(command, selection.folders);
  command
      .add_option("--only", selection.only,
                  "Only runs with this value of a column, a setting, or \"key\", e.g. seed=3; several of one name: any "
                  "of them")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false)  // so that folders may follow
      ->check(has_equals("NAME=VALUE"));
  command.add_flag("--all", selection.all,
                   "Use all jobs; by default only the newest of each label and config, e.g. of a rebuilt plugin");
  command.add_option("--labels", selection.labels, "Rename a label; can be given several times")
      ->type_name("OLD=NEW")
      ->allow_extra_args(false)
      ->check(has_equals("OLD=NEW"));
}

void use_runs(const RunSelection& selection, const std::function<void(std::vector<RunRecord>&)>& use) {
  use_runs(selection.folders, [&](std::vector<RunRecord>& runs) {
    if (!selection.only.empty()) keep_only(selection.only, runs);
    const std::size_t older = selection.all ? 0 : keep_newest_jobs(runs);
    if (older > 0) {
      fmt::print(stderr,
                 "remark: {} left out, as there is a newer job of the same label and config; --all includes {}\n",
                 older == 1 ? "1 older run is" : fmt::format("{} older runs are", older), older == 1 ? "it" : "them");
    }
    rename_labels(selection.labels, runs);
    use(runs);
  });
}

void keep_only(const std::vector<std::string>& only, std::vector<RunRecord>& runs) {
  const std::vector<RunColumn> columns = run_columns(runs);
  std::map<std::string, std::set<std::string>> asked;
  for (const std::string& condition : only) {
    const std::size_t equals = condition.find('=');
    asked[condition.substr(0, equals)].insert(condition.substr(equals + 1));
  }
  std::vector<char> fits(runs.size(), 1);
  for (const auto& [name, wanted] : asked) {
    const std::vector<std::string> values = values_of(name, columns, runs);
    for (std::size_t i = 0; i < runs.size(); ++i) fits[i] = fits[i] != 0 && wanted.contains(values[i]);
  }
  std::vector<RunRecord> left;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (fits[i] != 0) left.push_back(std::move(runs[i]));
  }
  if (left.empty()) throw InputError(fmt::format("none of {} runs is left by --only", runs.size()));
  runs = std::move(left);
}

void rename_labels(const std::vector<std::string>& renamed, std::vector<RunRecord>& runs) {
  std::map<std::string, std::string> names;
  std::set<std::string> labels;
  for (const RunRecord& run : runs) labels.insert(run.label);
  for (const std::string& text : renamed) {
    std::size_t equals = text.find('=');  // labels may also contain one
    while (!labels.contains(text.substr(0, equals)) && text.find('=', equals + 1) != std::string::npos) {
      equals = text.find('=', equals + 1);
    }
    const std::string old = text.substr(0, equals);
    if (!labels.contains(old)) {
      throw InputError(fmt::format("--labels {}: no run has the label \"{}\"{}", text, old,
                                   suggestion(old, std::vector(labels.begin(), labels.end()))));
    }
    names[old] = text.substr(equals + 1);
  }
  for (RunRecord& run : runs) {
    if (const auto found = names.find(run.label); found != names.end()) run.label = found->second;
  }
}

}  // namespace evbench
