#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace evbench::testing {

/// Paths of the shipped configs: all JSON files below configs/ except sweeps, the catalogue and published numbers.
inline std::vector<std::string> shipped_configs() {
  const std::set<std::string> others = {"datasets.json", "published.json"};
  std::vector<std::string> paths;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(EVBENCH_CONFIGS)) {
    const bool is_config = entry.path().extension() == ".json" && !others.contains(entry.path().filename().string()) &&
                           entry.path().parent_path().filename() != "sweeps";
    if (is_config) paths.push_back(entry.path().string());
  }
  return paths;
}

}  // namespace evbench::testing
