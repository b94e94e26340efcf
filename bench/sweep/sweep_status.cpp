#include "bench/sweep/sweep_status.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "bench/run_folder.hpp"
#include "core/io/atomic_file.hpp"
#include "core/support/error.hpp"
#include "eval/run_record.hpp"
#include "eval/sweep_record.hpp"

namespace evbench {
namespace fs = std::filesystem;
namespace {

void add_run(const std::string& folder, const SweepRecordRun& run, SweepStatus& status) {
  if (AtomicFolder::is_taken(folder)) {
    ++status.running;
    return;
  }
  std::string why;
  const RunCondition condition = condition_of(folder, run.key, why);
  if (condition == RunCondition::absent) {
    ++status.missing;
    return;
  }
  const std::string place = place_of(run.axes);
  const std::optional<TroubledRun> trouble = condition == RunCondition::damaged
                                                 ? TroubledRun{run.label, place, "damaged: " + why}
                                                 : trouble_of(read_record(folder), place);
  ++(trouble && !trouble->lost ? status.failed : status.done);
  if (trouble) status.troubled.push_back(*trouble);
}

SweepStatus read_one(const std::string& folder) {
  const SweepRecord sweep = read_sweep_record(folder + "/sweep.json");
  SweepStatus status;
  status.folder = folder;
  status.name = sweep.name;
  std::set<std::string> seen;
  for (const SweepRecordRun& run : sweep.runs) {
    if (!seen.insert(run.key).second) continue;
    ++status.runs;
    add_run(folder + "/" + run.key, run, status);
  }
  status.others = count_others(folder, sweep);
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

std::size_t count_others(const std::string& folder, const SweepRecord& sweep) {
  std::set<std::string> planned;
  for (const SweepRecordRun& run : sweep.runs) planned.insert(run.key);
  const auto is_other = [&](const fs::directory_entry& entry) {
    const std::string name = entry.path().filename().string();
    return !name.ends_with(".part") && !name.ends_with(".old") && !planned.contains(name) &&
           fs::exists(entry.path() / "job.json");
  };
  return static_cast<std::size_t>(std::ranges::count_if(fs::directory_iterator(folder), is_other));
}

std::string describe_others(std::size_t others) {
  return fmt::format("runs here that the sweep does not plan, and tables pass over: {}", others);
}

}  // namespace evbench
