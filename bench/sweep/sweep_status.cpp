#include "bench/sweep/sweep_status.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "bench/experiment.hpp"
#include "core/io/atomic_file.hpp"
#include "core/support/error.hpp"
#include "eval/run_record.hpp"

namespace evbench {
namespace fs = std::filesystem;
namespace {

std::string place_of(const Json& axes) {
  std::string text;
  for (const auto& [axis, value] : axes.items()) {
    text += fmt::format("{}{}={}", text.empty() ? "" : ", ", axis, value.get<std::string>());
  }
  return text;
}

void add_run(const std::string& folder, const std::string& label, const std::string& place, SweepStatus& status) {
  std::error_code error;
  if (AtomicFolder::is_taken(folder)) {
    ++status.running;
    return;
  }
  if (!fs::is_directory(folder, error)) {
    ++status.missing;
    return;
  }
  std::optional<TroubledRun> trouble;
  try {
    trouble = trouble_of(read_record(folder), place);
  } catch (const InputError& damage) {
    trouble = TroubledRun{label, place, fmt::format("damaged: {}", damage.what())};
  }
  ++(trouble && !trouble->lost ? status.failed : status.done);
  if (trouble) status.troubled.push_back(std::move(*trouble));
}

SweepStatus read_one(const std::string& folder) {
  const std::string path = folder + "/sweep.json";
  const Json json = read_json(path);
  SweepStatus status;
  status.folder = folder;
  std::set<std::string> seen;
  try {
    status.name = json.at("name").get<std::string>();
    for (const Json& run : json.at("runs")) {
      const auto key = run.at("key").get<std::string>();
      if (!seen.insert(key).second) continue;
      ++status.runs;
      add_run(folder + "/" + key, run.at("label").get<std::string>(), place_of(run.at("axes")), status);
    }
  } catch (const Json::exception& error) {
    throw InputError(fmt::format("{}: is not the plan of a sweep; evbench sweep writes it again", path));
  }
  return status;
}

}  // namespace

std::vector<SweepStatus> read_sweep_status(const std::string& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) throw InputError(fmt::format("{}: is not a folder", folder));
  const auto is_sweep = [&](const fs::path& path) { return fs::is_regular_file(path / "sweep.json", error); };
  if (is_sweep(folder)) return {read_one(folder)};
  std::vector<std::string> sweeps;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (is_sweep(entry.path())) sweeps.push_back(entry.path().string());
  }
  if (sweeps.empty()) {
    throw InputError(
        fmt::format("{}: no sweep.json in it or in a folder below; expected what evbench sweep wrote", folder));
  }
  std::ranges::sort(sweeps);
  std::vector<SweepStatus> result;
  for (const std::string& sweep : sweeps) result.push_back(read_one(sweep));
  return result;
}

}  // namespace evbench
