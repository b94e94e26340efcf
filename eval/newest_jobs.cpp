#include "eval/newest_jobs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

#include "core/io/utc_time.hpp"
#include "core/support/json.hpp"

namespace evbench {
namespace {

/// A run's config as text; empty if it is not known.
std::string config_of(const RunRecord& run) {
  if (!run.done || run.settings.empty() || run.key.empty()) return "";
  std::string text = fmt::format("{}\n{}\n{}\n", run.experiment, run.label, run.seed ? std::to_string(*run.seed) : "");
  for (const auto& [axis, value] : run.axes) text += fmt::format("{}={}\n", axis, value);
  for (const auto& [path, value] : run.settings) text += fmt::format("{}={}\n", path, dump_json(value));
  return text;
}

/// The time of the run as UTC text, which compares like a time; empty if it is not known.
std::string finished_at(const std::string& folder) {
  std::ifstream file(folder + "/manifest.json");
  const Json manifest = try_parse_json(std::string(std::istreambuf_iterator<char>(file), {}));
  if (manifest.is_object()) {
    const auto found = manifest.find("finished");
    if (found != manifest.end() && found->is_string()) return found->get<std::string>();
  }
  std::error_code error;
  const auto written = std::filesystem::last_write_time(folder + "/metrics.json", error);
  if (error) return "";
  return utc_time(std::chrono::file_clock::to_sys(written));
}

}  // namespace

std::size_t keep_newest_jobs(std::vector<RunRecord>& runs) {
  std::map<std::string, std::map<std::string, std::vector<std::size_t>>> jobs;  // by config, then by key
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (const std::string config = config_of(runs[i]); !config.empty()) jobs[config][runs[i].key].push_back(i);
  }
  std::vector<char> leave_out(runs.size());
  for (const auto& [config, by_key] : jobs) {
    if (by_key.size() < 2) continue;
    std::map<std::string, std::string> finished;
    for (const auto& [key, indices] : by_key) {
      for (const std::size_t i : indices) finished[key] = std::max(finished[key], finished_at(runs[i].folder));
    }
    const std::string newest =
        std::ranges::max_element(finished, {}, [](const auto& job) { return job.second; })->first;
    for (const auto& [key, indices] : by_key) {
      for (const std::size_t i : indices) leave_out[i] = key != newest;
    }
  }
  std::vector<RunRecord> kept;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (leave_out[i] == 0) kept.push_back(std::move(runs[i]));
  }
  const std::size_t left_out = runs.size() - kept.size();
  runs = std::move(kept);
  return left_out;
}

}  // namespace evbench
