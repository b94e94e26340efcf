#include "eval/score_run.hpp"

#include <filesystem>
#include <map>
#include <optional>
#include <vector>

#include "core/data/causal_poses.hpp"
#include "core/data/tum.hpp"
#include "core/data/velocity_file.hpp"
#include "core/io/file_content.hpp"
#include "eval/covariance_scores.hpp"
#include "eval/latency.hpp"
#include "eval/old_names.hpp"

namespace evbench {
namespace {

/// The protocol's time range, limited to that of the run.
OptionSet::List clip(const OptionSet::List& range, const std::optional<TimeRange>& run) {
  if (!run) return range;
  if (range.size() != 2) return {run->from, run->to};
  return {std::max(range[0], run->from), std::min(range[1], run->to)};
}

struct RunTrajectories {
  PoseTrajectory ground_truth;  ///< empty if missing
  RunEstimate estimate;
};

/// Velocities of the poses that were the newest when they were published.
BodyVelocities published_velocities(const std::string& path) {
  std::vector<StampedVelocity> velocities;
  for (const CausalPose& pose : read_causal_poses(path)) {
    if (!velocities.empty() && pose.t <= velocities.back().t) continue;
    if (!pose.velocity) return {};
    velocities.push_back({pose.t, *pose.velocity});
  }
  return BodyVelocities(std::move(velocities));
}

RunTrajectories read_trajectories(const std::string& folder, bool causal) {
  const std::string truth = folder + "/groundtruth.tum";
  return {is_file(truth) ? read_tum(truth) : PoseTrajectory(), read_run_estimate(folder, {.causal = causal})};
}

Scores compare_with_velocities(const RunTrajectories& run, const ScoreOptions& options, const RunRecord& record) {
  Scores scores = score_poses(run.ground_truth, run.estimate.poses, options, record);
  score_velocities(run.ground_truth, {}, run.estimate.poses, run.estimate.velocities, scores);
  return scores;
}

/// Scores the estimates that were available `latency` [s] after the time of each ground-truth pose.
Json scores_at_latency(const PoseTrajectory& ground_truth, const std::vector<CausalPose>& published, double latency,
                       const ScoreOptions& options, const RunRecord& record) {
  std::vector<double> times;
  for (const StampedPose& pose : ground_truth.poses()) times.push_back(pose.t - options.time_offset);
  try {
    Json json = to_json(score_poses(ground_truth, estimates_at_latency(published, times, latency), options, record));
    json["latency_s"] = latency;
    return json;
  } catch (const InputError&) {
    return nullptr;
  }
}

/// Adds to the scores of the causal estimate those at zero and at equal latency, if there are published poses.
void add_latencies(const std::string& folder, const PoseTrajectory& ground_truth, const ScoreOptions& options,
                   const RunRecord& record, Json& scores) {
  const std::string path = file_of_run(folder, "causal_poses.txt");
  if (!is_file(path)) return;
  const std::vector<CausalPose> published = read_causal_poses(path);
  if (const std::optional<Delay> delay = delay_of(published)) {
    scores["delay_s"] = {{"median", delay->median}, {"p99", delay->p99}, {"max", delay->max}};
  }
  scores["zero_latency"] = scores_at_latency(ground_truth, published, 0.0, options, record);
  scores["equal_latency"] = scores_at_latency(ground_truth, published, options.latency, options, record);
}

/// Covariance scores by kind.
Json covariance_scores(const std::vector<RelativePose>& poses, const PoseTrajectory& ground_truth, double scale,
                       double time_offset) {
  std::map<std::string, std::vector<RelativePose>> kinds;
  for (const RelativePose& pose : poses) kinds[pose.kind].push_back(pose);
  Json json = Json::object();
  for (const auto& [kind, of_kind] : kinds) {
    json[kind] = to_json(score_covariances(of_kind, ground_truth, scale, time_offset));
  }
  return json;
}

}  // namespace

PoseTrajectory read_run_poses(const std::string& folder, const EstimateName& name) {
  const std::string path = file_of_run(folder, name.causal ? "causal.tum" : "final" + name.segment + ".tum");
  std::error_code error;
  const bool empty = is_file(path) && std::filesystem::file_size(path, error) == 0;
  return empty ? PoseTrajectory() : read_tum(path);
}

BodyVelocities read_run_velocities(const std::string& folder, const EstimateName& name) {
  const std::string path = file_of_run(folder, name.causal ? "causal_poses.txt" : "velocities" + name.segment + ".txt");
  if (!is_file(path)) return {};
  return name.causal ? published_velocities(path) : read_velocities(path);
}

RunEstimate read_run_estimate(const std::string& folder, const EstimateName& name) {
  return {read_run_poses(folder, name), read_run_velocities(folder, name)};
}

Scores score_poses(const PoseTrajectory& ground_truth, const PoseTrajectory& estimate, ScoreOptions options,
                   const RunRecord& record) {
  if (estimate.empty()) {  // a run that broke off has no ground truth either
    const std::string reason = record.status ? record.status->status.reason : "";
    throw InputError(reason.empty() ? "no trajectory" : "no trajectory: " + reason);
  }
  if (ground_truth.empty()) throw InputError(kNoGroundTruth);
  const OptionSet::List asked = options.time_range;
  options.time_range = clip(asked, record.range);
  if (asked.size() == 2 && !(options.time_range[0] < options.time_range[1])) {
    throw InputError(fmt::format("the time range to evaluate, {} to {} s, is outside of the run's, {} to {} s",
                                 asked[0], asked[1], record.range->from, record.range->to));
  }
  return score(ground_truth, estimate, options);
}

void score_run(const std::string& folder, const ScoreOptions& options, RunRecord& record) {
  const auto set = [&](bool causal, Json& scores, std::string& unscored) {
    const RunTrajectories trajectories = read_trajectories(folder, causal);
    scores = nullptr;
    unscored.clear();
    try {
      scores = to_json(compare_with_velocities(trajectories, options, record));
    } catch (const InputError& error) {
      unscored = error.what();
      return;
    }
    if (causal) add_latencies(folder, trajectories.ground_truth, options, record, scores);
  };
  set(false, record.final_scores, record.final_unscored);
  set(true, record.causal_scores, record.causal_unscored);
  record.covariance = nullptr;
  if (const std::string path = folder + "/covariance.txt"; is_file(path) && !record.final_scores.is_null()) {
    record.covariance = covariance_scores(read_relative_poses(path), read_tum(folder + "/groundtruth.tum"),
                                          record.final_scores.at("scale").get<double>(), options.time_offset);
  }
}

Json scores_of(const std::string& folder, bool causal, const ScoreOptions& options, const RunRecord& record) {
  const RunTrajectories trajectories = read_trajectories(folder, causal);
  Json scores = to_json(compare_with_velocities(trajectories, options, record));
  if (causal) add_latencies(folder, trajectories.ground_truth, options, record, scores);
  return scores;
}

ScoredEstimate score_estimate(const std::string& folder, bool causal, const ScoreOptions& options,
                              const RunRecord& record) {
  RunTrajectories run = read_trajectories(folder, causal);
  try {
    Scores scores = compare_with_velocities(run, options, record);
    return {std::move(run.estimate.poses), std::move(scores)};
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", folder, error.what()));
  }
}

}  // namespace evbench
