#include "bench/run_index.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "core/io/atomic_file.hpp"
#include "core/support/error.hpp"
#include "eval/find_runs.hpp"
#include "eval/table.hpp"
#include "eval/table_notes.hpp"

namespace evbench {
namespace fs = std::filesystem;
namespace {

/// Lock of a folder, held by one process at a time, so that no process writes an index that misses another one's run.
/// On file systems without folder locks an index may miss a run until the next run is added.
class FolderLock {
 public:
  explicit FolderLock(const std::string& path) : folder_(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
    if (folder_ >= 0) ::flock(folder_, LOCK_EX);
  }
  ~FolderLock() {
    if (folder_ >= 0) ::close(folder_);
  }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int folder_;
};

/// The runs in the folder, with their folders relative to it.
std::vector<RunRecord> runs_in(const std::string& experiment) {
  std::vector<RunRecord> runs;
  std::error_code error;
  for (auto entry = fs::directory_iterator(experiment, error); entry != fs::directory_iterator();
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.ends_with(".part") || name.ends_with(".old")) continue;
    if (!fs::exists(entry->path() / "metrics.json", error)) continue;
    try {
      RunRecord run = read_record(entry->path().string());
      (void)collect_protocols(numbers_of({&run, 1}, false));
      run.folder = name;
      runs.push_back(std::move(run));
    } catch (const InputError&) {  // damaged: tables report it
    }
  }
  const auto comes_first = [](const RunRecord& a, const RunRecord& b) {
    if (a.experiment != b.experiment) return natural_less(a.experiment, b.experiment);
    if (a.label != b.label) return natural_less(a.label, b.label);
    if (a.settings != b.settings) return settings_less(a.settings, b.settings);
    return a.seed != b.seed ? a.seed < b.seed : a.folder < b.folder;
  };
  std::ranges::sort(runs, comes_first);
  return runs;
}

/// Whether a run's folder is newer than the index.
bool has_newer_run(const std::string& experiment) {
  std::error_code error;
  const fs::file_time_type written = fs::last_write_time(experiment + "/index.csv", error);
  const bool missing = static_cast<bool>(error);
  for (fs::directory_iterator entry(experiment, error), end; !error && entry != end; entry.increment(error)) {
    std::error_code gone;
    if (!entry->is_directory(gone) || !fs::exists(entry->path() / "metrics.json", gone)) continue;
    if (missing || entry->last_write_time(gone) > written) return true;
  }
  return false;
}

}  // namespace

RunIndex::RunIndex(std::string experiment)
    : experiment_(std::move(experiment)), outdated_(!experiment_.empty() && has_newer_run(experiment_)) {}

void write_run_index(const std::string& experiment) {
  const FolderLock lock(experiment);
  const std::string path = experiment + "/index.csv";
  const std::vector<RunRecord> runs = runs_in(experiment);
  if (runs.empty()) {
    std::error_code ignored;
    fs::remove(path, ignored);
    return;
  }
  TableOptions options{.format = TableFormat::csv, .metrics = {"status"}};
  const std::vector<RunNumbers> numbers = numbers_of(runs, false);
  for (const char* key : {"ate.trans_m.rmse", "ate.rot_deg.rmse", "rpe.trans_m.rmse", "rpe.rot_deg.rmse"}) {
    if (any_has(numbers, key)) options.metrics.emplace_back(key);
  }
  write_file(path, make_table(runs, options));
}

void RunIndex::add() {
  outdated_ = true;
  if (Clock::now() >= due_) write();
}

void RunIndex::write() {
  if (!outdated_) return;
  const Clock::time_point begin = Clock::now();
  write_run_index(experiment_);
  outdated_ = false;
  due_ = Clock::now() + 20 * (Clock::now() - begin);
}

}  // namespace evbench
