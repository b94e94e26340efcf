#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "core/support/error.hpp"
#include "eval/run_record.hpp"

namespace evbench {
namespace fs = std::filesystem;
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// The digits at `at` without leading zeros; `at` moves behind them.
std::string take_number(const std::string& text, std::size_t& at) {
  while (at < text.size() && text[at] == '0') ++at;
  const std::size_t begin = at;
  while (at < text.size() && is_digit(text[at])) ++at;
  return text.substr(begin, at - begin);
}

/// Every folder with a metrics.json in and below a folder; `missing`: those of runs that have none.
std::vector<fs::path> find_folders(const std::string& folder, std::vector<fs::path>& missing) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) throw InputError(fmt::format("{}: is not a folder", folder));
  std::vector<fs::path> folders;
  const auto options = fs::directory_options::skip_permission_denied;
  // Sweeps write while tables are made: what vanishes in between is passed over.
  for (auto entry = fs::recursive_directory_iterator(folder, options, error); entry != fs::end(entry);
       entry.increment(error)) {
    const fs::path extension = entry->path().extension();
    if (extension == ".part" || extension == ".old") entry.disable_recursion_pending();
    const fs::path within = entry->path().parent_path();
    if (entry->path().filename() == "metrics.json" && entry->is_regular_file(error)) folders.push_back(within);
    if (entry->path().filename() == "job.json" && !fs::exists(within / "metrics.json", error))
      missing.push_back(within);
  }
  if (folders.empty() && missing.empty()) {
    throw InputError(
        fmt::format("{}: no metrics.json in it or below; expected the folder of a run or of several", folder));
  }
  return folders;
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
  return a < b;  // equal but for leading zeros
}

std::vector<RunRecord> find_runs(std::span<const std::string> folders, std::vector<std::string>* unreadable) {
  std::vector<RunRecord> runs;
  std::vector<fs::path> missing;
  std::set<fs::path> seen;
  for (const std::string& folder : folders) {
    for (const fs::path& run : find_folders(folder, missing)) {
      if (!seen.insert(fs::canonical(run)).second) continue;
      try {
        runs.push_back(read_record(run.string()));
      } catch (const InputError& error) {
        if (unreadable == nullptr) throw;
        unreadable->emplace_back(error.what());
      }
    }
  }
  if (unreadable != nullptr) {
    for (const fs::path& run : missing) {
      if (!seen.insert(fs::canonical(run)).second) continue;
      unreadable->push_back(fmt::format("{}: is the folder of a run without metrics.json; run it again", run.string()));
    }
  }
  std::ranges::sort(runs, [](const RunRecord& a, const RunRecord& b) {
    if (a.experiment != b.experiment) return natural_less(a.experiment, b.experiment);
    if (a.position != b.position) return a.position < b.position;
    if (a.label != b.label) return natural_less(a.label, b.label);
    if (a.settings != b.settings) return settings_less(a.settings, b.settings);
    if (a.seed != b.seed) return a.seed < b.seed;
    return a.folder < b.folder;
  });
  return runs;
}

}  // namespace evbench
