#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <string>

#include "bench/testing/program.hpp"
#include "core/support/json.hpp"

namespace evbench::testing {

/// Config of a run that takes little time.
inline Json tiny_config() {
  Json config = short_config();
  config["name"] = "tiny";
  config["source"]["duration"] = 1;
  config["backend"]["batch_duration"] = 0.1;
  return config;
}

/// All files of an experiment's runs, by path, without measured times and memory.
inline std::map<std::string, std::string> results_of(const std::string& experiment) {
  std::map<std::string, std::string> results;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(experiment)) {
    const std::string path = entry.path().lexically_relative(experiment).string(), name = entry.path().filename();
    if (!entry.is_regular_file() || name == "timing.csv" || path.starts_with("slurm/")) continue;
    std::string content = read_file(entry.path().string());
    if (name == "metrics.json") {
      Json metrics = parse_json(content);
      for (const char* const measured : {"runtime_s", "realtime_factor", "times", "peak_rss_mib"})
        metrics.erase(measured);
      content = dump_json(metrics);
    }
    if (name == "manifest.json") {
      Json manifest = parse_json(content);
      manifest.erase("finished");
      content = dump_json(manifest);
    }
    results[path] = content;
  }
  return results;
}

/// Describes where two sets of results differ; empty if they are equal.
inline std::string difference(const std::map<std::string, std::string>& a,
                              const std::map<std::string, std::string>& b) {
  std::string text;
  for (const auto& [path, content] : a) {
    const auto other = b.find(path);
    if (other == b.end()) {
      text += path + " is missing; ";
    } else if (other->second != content) {
      text += path + " differs; ";
    }
  }
  for (const auto& [path, content] : b) {
    if (!a.contains(path)) text += path + " is unexpected; ";
  }
  return text;
}

}  // namespace evbench::testing
