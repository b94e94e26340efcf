#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/support/json.hpp"
#include "core/testing/data.hpp"
#include "eval/find_runs.hpp"
#include "eval/scores.hpp"
#include "eval/testing/trajectories.hpp"

namespace evbench::testing {

/// Real scores with another ATE.
inline Json scores_with(double ate, const std::string& alignment = "sim3") {
  const PoseTrajectory truth = sample(wavy_pose, 100, 0.01);
  ScoreOptions options;
  options.alignment = alignment;
  Json json = to_json(score(truth, disturbed(truth), options));
  json["ate"]["trans_m"]["rmse"] = ate;
  return json;
}

/// The metrics.json of a run.
inline Json run(const std::string& experiment, const std::string& label, const Json& final_scores,
                const std::string& state = "ok") {
  RunRecord record;
  record.experiment = experiment;
  record.label = label;
  record.seed = 7;
  record.key = "mine-0123456789";
  record.final_scores = final_scores;
  record.runtime_s = 2.0;
  record.data_s = 3.0;
  record.realtime_factor = 1.5;
  record.times = {0.75, 0.25, 1.75, 0.5, 0.125, 2.5};
  record.peak_rss_mib = 30.0;
  Json json = to_json(record);
  json["status"] = {{"state", state}, {"reason", ""}, {"time", 3.25}};
  return json;
}

/// A folder of runs, as `evbench run` writes it.
struct Results {
  TemporaryFolder folder;
  void add(const std::string& name, const std::string& content) const {
    std::filesystem::create_directories(folder.file(name));
    folder.write(name + "/metrics.json", content);
  }
  void add(const std::string& name, const Json& metrics) const { add(name, dump_json(metrics)); }
  void add(const std::string& name, const Json& metrics, const Json& config) const {
    add(name, metrics);
    folder.write(name + "/config.json", dump_json(config));
  }
  /// Adds a run of this label and seed on the data of that seed, with an ATE; none: it failed.
  void add_seed(const std::string& label, int seed, std::optional<double> ate, double frame = 0.1,
                const std::string& motion = "arm") const {
    Json json = run("arm", label, ate ? scores_with(*ate) : Json(), ate ? "ok" : "failed");
    json["seed"] = seed;
    json["key"] = label + std::to_string(seed) + "-" + std::to_string(frame);
    add(json["key"].get<std::string>(), json,
        {{"seed", seed},
         {"source", {{"type", "simulation"}, {"motion", motion}}},
         {"frontend", {{"type", "oracle"}}},
         {"backend", {{"type", label}, {"batch_duration", frame}}}});
  }
  std::vector<RunRecord> find() const { return find_runs(std::vector{folder.path()}); }
};

inline std::string line_with(const std::string& text, const std::string& part) {
  const std::size_t at = text.find(part);
  if (at == std::string::npos) return "";
  const std::size_t begin = text.rfind('\n', at) + 1;
  return text.substr(begin, text.find('\n', at) - begin);
}

}  // namespace evbench::testing
