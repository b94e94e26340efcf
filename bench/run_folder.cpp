#include "bench/run_folder.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <fstream>
#include <thread>

#include "bench/version.hpp"
#include "core/data/tum.hpp"
#include "core/support/sha256.hpp"

namespace evbench {
namespace {

Json status_json(const Status& status) {
  Json json = {{"state", to_string(status.state)}};
  json["reason"] = status.reason;
  json["time"] = status.state == RunState::ok ? Json() : Json(status.time);
  json["degraded"] = Json::array();
  for (const DegradedSpan& span : status.degraded) {
    json["degraded"].push_back({{"from", span.from}, {"to", span.to}, {"reason", span.reason}});
  }
  return json;
}

std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  }
  return "unknown";
}

Json manifest_json(const RunConfig& config, const RunResult& result) {
  std::array<char, 256> host{};
  ::gethostname(host.data(), host.size() - 1);
  Json inputs = Json::object();
  for (const std::string& file : result.files) inputs[file] = sha256_file(file);
  return {{"program", {{"version", kVersion}, {"commit", kCommit}, {"build", kBuild}}},
          {"host", {{"name", host.data()}, {"processor", processor()}, {"cores", std::thread::hardware_concurrency()}}},
          {"seed", config.seed},
          {"config_sha256", sha256(config.resolved().dump())},
          {"inputs_sha256", inputs},
          {"tracks_sha256", result.tracks_sha256},
          {"observations", result.observations}};
}

std::string map_ply(const std::vector<Landmark>& map) {
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\ncomment landmarks in the back-end's world frame\nelement vertex {}\n"
      "property double x\nproperty double y\nproperty double z\nproperty int track\nend_header\n",
      map.size());
  for (const Landmark& l : map) {
    text += fmt::format("{:.9g} {:.9g} {:.9g} {}\n", l.position.x(), l.position.y(), l.position.z(), l.track);
  }
  return text;
}

std::string timing_csv(const std::vector<UpdateRecord>& updates) {
  std::string text = "t_s,update_ms,states,landmarks,observations,iterations,cost\n";
  for (const UpdateRecord& u : updates) {
    text += fmt::format("{:.6f},{:.4f},{},{},{},{},{}\n", u.t, 1e3 * u.seconds, u.states, u.landmarks, u.observations,
                        u.iterations, u.cost ? fmt::format("{:.9g}", *u.cost) : "");
  }
  return text;
}

std::string log_text(const RunConfig& config, const RunResult& result) {
  std::string text = fmt::format("{}\n{}: {}\n", version_text(), config.experiment, config.label);
  for (const std::string& line : result.log) text += line + "\n";
  return text + fmt::format("status: {} {}\n", to_string(result.status.state), result.status.reason);
}

}  // namespace

Json metrics_json(const RunConfig& config, const RunResult& result) {
  Json json = {{"experiment", config.experiment}, {"label", config.label}};
  json["final"] = result.final_scores ? to_json(*result.final_scores) : Json();
  json["online"] = result.online_scores ? to_json(*result.online_scores) : Json();
  if (!result.final_scores) json["final_unscored"] = result.final_unscored;
  if (!result.online_scores) json["online_unscored"] = result.online_unscored;
  json["runtime_s"] = result.runtime_s;
  json["realtime_factor"] = result.runtime_s > 0.0 ? Json(result.data_s / result.runtime_s) : Json();
  json["peak_rss_mib"] = result.peak_rss_mib;
  json["status"] = status_json(result.status);
  return json;
}

RunFolder::RunFolder(const std::string& out, const RunConfig& config)
    : path_(out + "/" + config.experiment + "/" + config.key()), folder_(path_) {}

void RunFolder::write(const RunConfig& config, const RunResult& result, bool problem) {
  const auto pretty = [](const Json& json) { return json.dump(2) + "\n"; };
  folder_.write("config.json", pretty(config.resolved()));
  folder_.write("manifest.json", pretty(manifest_json(config, result)));
  folder_.write("final.tum", format_tum(result.final_trajectory));
  folder_.write("online.tum", format_tum(result.online_trajectory));
  folder_.write("map.ply", map_ply(result.map));
  folder_.write("metrics.json", pretty(metrics_json(config, result)));
  folder_.write("timing.csv", timing_csv(result.updates));
  folder_.write("log.txt", log_text(config, result));
  folder_.write("status.json", pretty(status_json(result.status)));
  if (problem && result.problem) folder_.write("problem.txt", format_problem(*result.problem));
  folder_.commit();
}

}  // namespace evbench
