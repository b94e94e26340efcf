#include "bench/run_folder.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <thread>

#include "bench/version.hpp"
#include "core/data/map_file.hpp"
#include "core/data/tracks.hpp"
#include "core/data/tum.hpp"
#include "core/data/velocity_file.hpp"
#include "core/io/sha256.hpp"
#include "core/io/utc_time.hpp"
#include "eval/json_file.hpp"
#include "eval/score_run.hpp"

namespace evbench {
namespace fs = std::filesystem;
namespace {

/// Ground truth is kept beyond the time range, for a protocol with another time offset [s].
constexpr double kGroundTruthMargin = 1.0;

constexpr const char* kRewritten[] = {"config.json", "manifest.json", "metrics.json", "log.txt"};

std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  }
  return "unknown";
}

/// Sizes of a folder's files, except those that are rewritten when a run is relabelled or scored, and measured times.
Json sizes_json(const std::string& folder) {
  std::map<std::string, std::uintmax_t> sizes;  // by name: the order of a folder's entries is undefined
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const auto is_other = [&](const char* other) { return name == other; };
    if (std::ranges::any_of(kRewritten, is_other) || name == "timing.csv") continue;
    sizes[name] = fs::file_size(entry.path());
  }
  return sizes;
}

Json manifest_json(const RunConfig& config, const JobIdentity& identity, const RunResult& result,
                   const std::string& folder) {
  std::array<char, 256> host{};
  ::gethostname(host.data(), host.size() - 1);
  Json inputs = Json::object();
  for (const auto& [path, digest] : identity.files) inputs[path] = digest;
  return {{"program", {{"version", kVersion}, {"commit", kCommit}, {"build", kBuild}}},
          {"host", {{"name", host.data()}, {"processor", processor()}, {"cores", std::thread::hardware_concurrency()}}},
          {"finished", utc_time(std::chrono::system_clock::now())},
          {"seed", config.job.seed},
          {"key", identity.key},
          {"config_sha256", sha256(json_file_text(config.resolved()))},
          {"inputs_sha256", inputs},
          {"tracks_sha256", result.tracks_sha256},
          {"observations", result.observations},
          {"sizes", sizes_json(folder)}};
}

std::string timing_csv(const std::vector<UpdateRecord>& updates) {
  std::string text = "t_s,update_ms,states,landmarks,observations,iterations,cost\n";
  for (const UpdateRecord& u : updates) {
    text += fmt::format("{:.6f},{:.4f},{},{},{},{},{}\n", u.t, 1e3 * u.seconds, u.states, u.landmarks, u.observations,
                        u.iterations, u.cost ? fmt::format("{:.9g}", *u.cost) : "");
  }
  return text;
}

std::string parameters_csv(const RunResult& result) {
  std::string text = fmt::format("t_s,{}\n", fmt::join(result.estimated_parameters, ","));
  for (const UpdateRecord& u : result.updates) {
    if (!u.estimated.empty()) text += fmt::format("{:.6f},{:.6g}\n", u.t, fmt::join(u.estimated, ","));
  }
  return text;
}

std::string log_text(const RunConfig& config, const RunResult& result) {
  std::string text = fmt::format("{}\n{}: {}\n", version_text(), config.experiment, config.label);
  for (const std::string& line : result.log) text += line + "\n";
  return text + fmt::format("status: {} {}\n", to_string(result.status.state), result.status.reason);
}

RunStatus status_of(const Execution& execution) {
  const RunResult& result = execution.result;
  RunStatus status;
  status.status = result.status;
  status.complete = execution.complete;
  for (const StationaryPeriod& span : result.stationary) status.stationary.push_back({span.from, span.to});
  for (const TrajectorySegment& segment : result.segments) {
    const PoseTrajectory& poses =
        segment.final_trajectory.empty() ? segment.causal_trajectory : segment.final_trajectory;
    status.segments.push_back({poses.empty() ? 0.0 : poses.start(), poses.empty() ? 0.0 : poses.end(),
                               segment.final_trajectory.size(), segment.map.size()});
  }
  if (!result.segments.empty()) status.scored = result.longest + 1;
  return status;
}

/// The record without the scores and the sequence's time range.
RunRecord record_of(const RunConfig& config, const JobIdentity& identity, const Execution& execution) {
  const RunResult& result = execution.result;
  const RunTimes& times = result.times;
  RunRecord record;
  record.experiment = config.experiment;
  record.label = config.label;
  record.seed = config.job.seed;
  record.key = identity.key;
  record.position = config.position;
  record.settings = settings_of(config.resolved());
  record.status = status_of(execution);
  if (!execution.complete) return record;
  record.data_s = result.data_s;
  record.runtime_s = times.frontend + times.backend;
  record.realtime_factor = realtime_factor(*record.data_s, *record.runtime_s);
  record.times = {times.source, times.frontend, times.backend, times.waiting, times.harness, times.total};
  std::vector<double> updates;
  for (const UpdateRecord& update : result.updates) updates.push_back(update.seconds);
  record.times->slowest_5s = times.slowest_5s;
  record.times->frontend_ms = step_times(times.frontend_batches);
  record.times->backend_ms = step_times(updates);
  record.peak_rss_mib = result.peak_rss_mib;
  record.track_scores = execution.track_scores;
  record.events = Json::array();
  for (const RunEvent& event : result.events) {
    record.events.push_back({{"t", event.t}, {"kind", event.kind}, {"text", event.text}});
  }
  record.counters = result.counters.empty() ? Json() : Json(result.counters);
  return record;
}

void write_segment(const AtomicFolder& folder, const TrajectorySegment& segment, const std::string& suffix) {
  folder.write("final" + suffix + ".tum", format_tum(segment.final_trajectory));
  folder.write("causal" + suffix + ".tum", format_tum(segment.causal_trajectory));
  if (!segment.velocities.empty()) folder.write("velocities" + suffix + ".txt", format_velocities(segment.velocities));
  folder.write("causal_poses" + suffix + ".txt", format_causal_poses(segment.published));
  if (!segment.relative.empty()) folder.write("covariance" + suffix + ".txt", format_relative_poses(segment.relative));
  folder.write("map" + suffix + ".ply", format_map(segment.map));
}

void write_segments(const AtomicFolder& folder, const RunResult& result) {
  for (std::size_t i = 0; i < result.segments.size(); ++i) {
    write_segment(folder, result.segments[i], i == result.longest ? "" : fmt::format(".segment{}", i + 1));
  }
  if (result.segments.empty()) write_segment(folder, {}, "");
}

}  // namespace

EmptyFolders::EmptyFolders(const std::string& path) {
  std::error_code error;
  for (fs::path at = path; !at.empty() && !fs::exists(at, error); at = at.parent_path()) made_.push_back(at.string());
}

EmptyFolders::~EmptyFolders() {
  std::error_code ignored;
  for (const std::string& path : made_) fs::remove(path, ignored);  // fails for one that is not empty
}

std::string ground_truth_tum(const Source& source) {
  const TimeRange range = source.time_range();
  return format_tum(source.ground_truth().cut(range.from - kGroundTruthMargin, range.to + kGroundTruthMargin));
}

RunFolder::RunFolder(const std::string& out, const std::string& experiment, const std::string& key)
    : path_(out + "/" + experiment + "/" + key), made_(out + "/" + experiment), folder_(path_) {}

RunRecord RunFolder::write(const RunConfig& config, const JobIdentity& identity, const Source& source,
                           const std::string& ground_truth, const Execution& execution, bool problem) {
  const RunResult& result = execution.result;
  write_files(config, identity, result);
  if (!ground_truth.empty()) folder_.write("groundtruth.tum", ground_truth);
  if (!result.estimated_parameters.empty()) folder_.write("estimated_parameters.csv", parameters_csv(result));
  if (problem && !result.segments.empty() && result.segments[result.longest].problem) {
    folder_.write("problem.txt", format_problem(*result.segments[result.longest].problem));
  }
  if (result.tracks) {
    folder_.write("tracks.txt", format_tracks(result.tracks->observations));
    folder_.write("track_ends.txt", format_track_ends(result.tracks->ended));
  }
  RunRecord record = record_of(config, identity, execution);
  record.range = {source.time_range().from, source.time_range().to};
  return finish(config, identity, execution, std::move(record));
}

RunRecord RunFolder::write_broken_off(const RunConfig& config, const JobIdentity& identity, const std::string& reason,
                                      const std::vector<std::string>& log) {
  folder_.clear();
  Execution execution;
  execution.complete = false;
  execution.result.status = {RunState::failed, reason, 0.0, {}};
  execution.result.log = log;
  write_files(config, identity, execution.result);
  return finish(config, identity, execution, record_of(config, identity, execution));
}

/// Writes the files of every run, without its scores.
void RunFolder::write_files(const RunConfig& config, const JobIdentity& identity, const RunResult& result) const {
  folder_.write("config.json", json_file_text(config.resolved()));
  folder_.write("job.json", identity.text);
  write_segments(folder_, result);
  folder_.write("timing.csv", timing_csv(result.updates));
  folder_.write("log.txt", log_text(config, result));
}

RunRecord RunFolder::finish(const RunConfig& config, const JobIdentity& identity, const Execution& execution,
                            RunRecord record) {
  score_run(folder_.part(), config.evaluation, record);
  folder_.write("status.json", json_file_text(to_json(*record.status)));
  folder_.write("metrics.json", json_file_text(to_json(record)));
  folder_.write("manifest.json", json_file_text(manifest_json(config, identity, execution.result, folder_.part())));
  folder_.commit();
  record.folder = path_;
  return record;
}

}  // namespace evbench
