#pragma once

#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>

#include "core/plugin/options.hpp"
#include "core/support/json.hpp"
#include "core/testing/data.hpp"

namespace evbench::testing {

/// Exit code and output of a command.
struct Outcome {
  int exit_code = 0;
  std::string out, err;
};

/// Runs a shell command in `folder`; $evbench is the program.
inline Outcome shell(const TemporaryFolder& folder, const std::string& command) {
  const TemporaryFolder streams;
  const std::string line = "cd '" + folder.path() + "' && export evbench='" EVBENCH_PROGRAM "' && { " + command +
                           "; } > '" + streams.file("out") + "' 2> '" + streams.file("err") + "' < /dev/null";
  const int status = std::system(line.c_str());  // NOLINT(cert-env33-c,concurrency-mt-unsafe)
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_file(streams.file("out")), read_file(streams.file("err"))};
}

/// `evbench ARGUMENTS` in `folder`.
inline Outcome evbench(const TemporaryFolder& folder, const std::string& arguments) {
  return shell(folder, "\"$evbench\" " + arguments);
}

/// Names in a folder; empty if there is no such folder.
inline std::set<std::string> names_in(const std::string& path) {
  std::set<std::string> names;
  if (!std::filesystem::is_directory(path)) return names;
  for (const auto& entry : std::filesystem::directory_iterator(path)) names.insert(entry.path().filename().string());
  return names;
}

/// Folders of an experiment's runs, without files next to them such as the plan of a sweep.
inline std::set<std::string> runs_of(const std::string& experiment) {
  std::set<std::string> runs;
  for (const std::string& name : names_in(experiment)) {
    if (std::filesystem::is_directory(experiment + "/" + name)) runs.insert(experiment + "/" + name);
  }
  return runs;
}

/// Config of a simulated sequence of 3 s with few tracks, for one back-end.
inline Json short_config(const std::string& backend = "bundle_adjustment") {
  return {{"name", "short"},
          {"source",
           {{"type", "simulation"},
            {"duration", 3},
            {"motion", {{"kind", "robot_arm"}, {"period", 3}}},
            {"tracks", {{"alive", 50}, {"rate", {50, 100}}, {"lifetime", {2, 5}}}}}},
          {"frontend", {{"type", "oracle"}}},
          {"backend", {{"type", backend}}},
          {"evaluation", {{"association", "interpolated"}}}};
}

/// Config of the short sequence for both back-ends.
inline Json short_comparison() {
  Json config = short_config();
  config.erase("backend");
  config["backends"] = {{{"type", "gp_map"}, {"label", "asynchronous"}},
                        {{"type", "bundle_adjustment"}, {"label", "frames of 50 ms"}}};
  return config;
}

/// Writes a recording of 1 s: calibration, ground truth, tracks of fixed pixels, and the config "recording.json" with
/// relative paths.
inline void write_recording(const TemporaryFolder& folder) {
  std::string truth, tracks;
  for (int i = 0; i <= 100; ++i) truth += std::to_string(0.01 * i) + " " + std::to_string(0.001 * i) + " 0 0 0 0 0 1\n";
  for (int i = 0; i < 200; ++i) {
    const int track = i % 20;
    tracks += std::to_string(track) + " " + std::to_string(0.005 * i) + " " + std::to_string(10 * track) + " " +
              std::to_string(20 + 7 * track) + "\n";
  }
  folder.write("calib.txt", "200 200 120 90 0 0 0 0 0\n");
  folder.write("groundtruth.txt", truth);
  folder.write("tracks.txt", tracks);
  Json config = short_config();
  config["name"] = "recording";
  config["source"] = {{"type", "recording"}, {"folder", "."}};
  config["frontend"] = {{"type", "recorded"}, {"tracks", "tracks.txt"}};
  folder.write("recording.json", dump_json(config));
}

}  // namespace evbench::testing
