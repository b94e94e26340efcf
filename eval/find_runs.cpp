#include "eval/find_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <map>
#include <numeric>
#include <set>
#include <tuple>

#include "core/support/error.hpp"
#include "core/support/index.hpp"
#include "core/support/parallel.hpp"
#include "eval/sweep_record.hpp"

namespace evbench {
namespace fs = std::filesystem;
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// The digits at `at` without leading zeros; moves `at` past them.
std::string take_number(const std::string& text, std::size_t& at) {
  while (at < text.size() && text[at] == '0') ++at;
  const std::size_t begin = at;
  while (at < text.size() && is_digit(text[at])) ++at;
  return text.substr(begin, at - begin);
}

/// A folder by the path on which it was found, and its canonical path.
struct Place {
  std::string path, canonical;
};

/// The runs and sweeps in and below the searched folders, each once.
struct Places {
  std::vector<Place> runs;     ///< with a metrics.json
  std::vector<Place> missing;  ///< of runs without metrics.json
  std::vector<Place> sweeps;   ///< with a sweep.json
};

/// Searches in and below one folder.
Places find_places(const std::string& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) throw InputError(fmt::format("{}: is not a folder", folder));
  const fs::path canonical = fs::canonical(folder);
  Places places;
  const auto options = fs::directory_options::skip_permission_denied;
  // A sweep may be writing at the same time: files that vanish in between are skipped.
  for (auto entry = fs::recursive_directory_iterator(folder, options, error); entry != fs::end(entry);
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.ends_with(".part") || name.ends_with(".old")) entry.disable_recursion_pending();
    const bool metrics = name == "metrics.json", job = name == "job.json", sweep = name == "sweep.json";
    if (!(metrics || job || sweep) || !entry->is_regular_file(error)) continue;
    const fs::path within = entry->path().parent_path();
    const fs::path below = within.lexically_relative(folder);  // "." is the folder itself
    const Place place{within.string(), (below == "." ? canonical : canonical / below).string()};
    if (metrics) places.runs.push_back(place);
    if (job && !fs::exists(within / "metrics.json", error)) places.missing.push_back(place);
    if (sweep) places.sweeps.push_back(place);
  }
  if (places.runs.empty() && places.missing.empty() && places.sweeps.empty()) {
    throw InputError(
        fmt::format("{}: no metrics.json in it or below; expected the folder of a run or of several", folder));
  }
  return places;
}

Places find_places(std::span<const std::string> folders) {
  Places all;
  std::set<std::string> seen[3];
  for (const std::string& folder : folders) {
    const Places places = find_places(folder);
    const auto add = [](const std::vector<Place>& from, std::set<std::string>& known, std::vector<Place>& to) {
      std::ranges::copy_if(from, std::back_inserter(to),
                           [&](const Place& place) { return known.insert(place.canonical).second; });
    };
    add(places.runs, seen[0], all.runs);
    add(places.missing, seen[1], all.missing);
    add(places.sweeps, seen[2], all.sweeps);
  }
  return all;
}

/// A run, and its place in its sweep's plan.
struct FoundRun {
  RunRecord record;
  std::size_t planned = 0;
};

/// Reads records by canonical path, with as many threads as there are processors. Unreadable runs are left out, with a
/// message each.
std::map<std::string, RunRecord> read_records(const std::vector<Place>& places,
                                              std::map<std::string, std::string>& unreadable) {
  std::vector<RunRecord> records(places.size());
  std::vector<std::string> failures(places.size());
  std::vector<std::exception_ptr> errors(places.size());
  parallel_for(0, static_cast<int>(places.size()), [&](int i) {
    try {
      records[index(i)] = read_record(places[index(i)].path);
    } catch (const InputError& error) {
      failures[index(i)] = error.what();
    } catch (...) {
      errors[index(i)] = std::current_exception();
    }
  });
  std::map<std::string, RunRecord> by_folder;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (errors[i]) std::rethrow_exception(errors[i]);
    if (failures[i].empty()) by_folder.emplace(places[i].canonical, std::move(records[i]));
    if (!failures[i].empty()) unreadable.emplace(places[i].canonical, failures[i]);
  }
  return by_folder;
}

RunRecord not_run(const SweepRecordRun& run, const std::string& folder) {
  RunRecord record;
  const auto seed = std::ranges::find(run.axes, "seed", &RunAxes::value_type::first);
  if (seed != run.axes.end()) record.seed = std::strtoull(seed->second.c_str(), nullptr, 10);
  record.key = run.key;
  record.folder = folder;
  record.done = false;
  return record;
}

/// Moves the records of a sweep's runs out of `records`, in the order of its plan. `unreadable`: the reason by folder.
void take_sweep(const Place& sweep, const std::map<std::string, std::string>& unreadable,
                std::map<std::string, RunRecord>& records, std::vector<FoundRun>& runs) {
  const SweepRecord plan = read_sweep_record(sweep.path + "/sweep.json");
  std::map<std::string, RunRecord> own;  // several places of a sweep may have the same run
  const std::string prefix = sweep.canonical + "/";
  for (auto it = records.lower_bound(prefix); it != records.end() && it->first.starts_with(prefix);) {
    own.insert(records.extract(it++));
  }
  for (std::size_t i = 0; i < plan.runs.size(); ++i) {
    const SweepRecordRun& planned = plan.runs[i];
    const std::string folder = prefix + planned.key;
    const auto found = own.find(folder);
    RunRecord record = found != own.end() ? found->second : not_run(planned, sweep.path + "/" + planned.key);
    if (const auto bad = unreadable.find(folder); bad != unreadable.end()) record.damage = bad->second;
    record.experiment = plan.name;
    record.label = planned.label;
    record.axes = planned.axes;
    runs.push_back({std::move(record), i});
  }
}

bool comes_before(const FoundRun& x, const FoundRun& y) {
  const RunRecord &a = x.record, &b = y.record;
  if (a.experiment != b.experiment) return natural_less(a.experiment, b.experiment);
  if (x.planned != y.planned) return x.planned < y.planned;
  if (a.position != b.position) return a.position < b.position;
  if (a.label != b.label) return natural_less(a.label, b.label);
  if (a.settings != b.settings) return settings_less(a.settings, b.settings);
  if (a.seed != b.seed) return a.seed < b.seed;
  return a.folder < b.folder;
}

}  // namespace

bool natural_less(const std::string& a, const std::string& b) {
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (is_digit(a[i]) && is_digit(b[j])) {
      const std::string x = take_number(a, i), y = take_number(b, j);
      if (x.size() != y.size()) return x.size() < y.size();
      if (x != y) return x < y;
    } else {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i;
      ++j;
    }
  }
  if (a.size() - i != b.size() - j) return a.size() - i < b.size() - j;
  return a < b;  // equal except for leading zeros
}

std::vector<RunRecord> find_runs(std::span<const std::string> folders, std::vector<std::string>* unreadable) {
  const Places places = find_places(folders);
  std::map<std::string, std::string> failures;
  std::map<std::string, RunRecord> records = read_records(places.runs, failures);
  if (!failures.empty() && unreadable == nullptr) throw InputError(failures.begin()->second);
  for (const Place& run : places.missing) {
    failures.emplace(run.canonical, run.path + ": is the folder of a run without metrics.json; run it again");
  }
  std::vector<FoundRun> runs;
  for (const Place& sweep : places.sweeps) take_sweep(sweep, failures, records, runs);
  for (auto& [folder, record] : records) runs.push_back({std::move(record)});
  std::ranges::sort(runs, comes_before);
  std::vector<RunRecord> result;
  for (FoundRun& run : runs) result.push_back(std::move(run.record));
  if (unreadable != nullptr) {
    unreadable->clear();
    for (auto& [folder, why] : failures) unreadable->push_back(std::move(why));
  }
  return result;
}

}  // namespace evbench
