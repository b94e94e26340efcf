#include "bench/sweep/sweep_status.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "core/io/atomic_file.hpp"
#include "core/support/error.hpp"
#include "eval/run_record.hpp"
#include "eval/sweep_record.hpp"

namespace evbench {
namespace fs = std::filesystem;
namespace {

void add_run(const std::string& folder, const SweepRecordRun& run, SweepStatus& status) {
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
    trouble = trouble_of(read_record(folder), place_of(run.axes));
  } catch (const InputError& damage) {
    trouble = TroubledRun{run.label, place_of(run.axes), fmt::format("damaged: {}", damage.what())};
  }
  ++(trouble && !trouble->lost ? status.failed : status.done);
  if (trouble) status.troubled.push_back(std::move(*trouble));
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
