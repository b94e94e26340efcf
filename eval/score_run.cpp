#include "eval/score_run.hpp"

#include <filesystem>

#include "core/data/tum.hpp"

namespace evbench {
namespace {

/// An estimate's file: empty where there is no estimate.
PoseTrajectory read_estimate(const std::string& path) {
  std::error_code error;
  const bool empty = std::filesystem::is_regular_file(path, error) && std::filesystem::file_size(path, error) == 0;
  return empty ? PoseTrajectory() : read_tum(path);
}

/// The protocol's time range, as far as the run goes.
OptionSet::List clip(const OptionSet::List& range, const std::optional<TimeRange>& run) {
  if (!run) return range;
  if (range.size() != 2) return {run->from, run->to};
  return {std::max(range[0], run->from), std::min(range[1], run->to)};
}

struct Outcome {
  Json scores;
  std::string unscored;
};

Outcome score_estimate(const PoseTrajectory& ground_truth, const PoseTrajectory& estimate, ScoreOptions options,
                       const RunRecord& record) {
  if (ground_truth.empty()) return {nullptr, "no ground truth"};
  if (estimate.empty()) {
    const std::string reason = record.status ? record.status->status.reason : "";
    return {nullptr, reason.empty() ? "no trajectory" : "no trajectory: " + reason};
  }
  const OptionSet::List asked = options.time_range;
  options.time_range = clip(asked, record.range);
  if (asked.size() == 2 && !(options.time_range[0] < options.time_range[1])) {
    return {nullptr, fmt::format("the time range to evaluate, {} to {} s, is outside of the run's, {} to {} s",
                                 asked[0], asked[1], record.range->from, record.range->to)};
  }
  try {
    return {to_json(score(ground_truth, estimate, options)), ""};
  } catch (const InputError& error) {
    return {nullptr, error.what()};
  }
}

}  // namespace

void score_run(const std::string& folder, const ScoreOptions& options, RunRecord& record) {
  const std::string truth_path = folder + "/groundtruth.tum";
  const PoseTrajectory truth = std::filesystem::exists(truth_path) ? read_tum(truth_path) : PoseTrajectory();
  Outcome final = score_estimate(truth, read_estimate(folder + "/final.tum"), options, record);
  Outcome online = score_estimate(truth, read_estimate(folder + "/online.tum"), options, record);
  record.final_scores = std::move(final.scores);
  record.final_unscored = std::move(final.unscored);
  record.online_scores = std::move(online.scores);
  record.online_unscored = std::move(online.unscored);
}

}  // namespace evbench
