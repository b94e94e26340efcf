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

/// Every metrics.json in and below a folder.
std::vector<fs::path> find_files(const std::string& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) throw InputError(fmt::format("{}: is not a folder", folder));
  std::vector<fs::path> files;
  const auto options = fs::directory_options::skip_permission_denied;
  // Sweeps write while tables are made: what vanishes in between is passed over.
  for (auto entry = fs::recursive_directory_iterator(folder, options, error); entry != fs::end(entry);
       entry.increment(error)) {
    const fs::path extension = entry->path().extension();
    if (extension == ".part" || extension == ".old") entry.disable_recursion_pending();
    if (entry->path().filename() == "metrics.json" && entry->is_regular_file(error)) files.push_back(entry->path());
  }
  if (files.empty()) {
    throw InputError(
        fmt::format("{}: no metrics.json in it or below; expected the folder of a run or of several", folder));
  }
  return files;
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

std::vector<RunRecord> find_runs(std::span<const std::string> folders) {
  std::vector<RunRecord> runs;
  std::set<fs::path> seen;
  for (const std::string& folder : folders) {
    for (const fs::path& file : find_files(folder)) {
      if (seen.insert(fs::canonical(file)).second) runs.push_back(read_record(file.parent_path().string()));
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
