#include "bench/report/run_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/report/column.hpp"
#include "bench/report/damage.hpp"
#include "bench/report/newest_poses.hpp"
#include "bench/report/scored_trajectory.hpp"
#include "bench/report/track_lives.hpp"
#include "bench/report/updates.hpp"
#include "bench/scores_by_protocol.hpp"
#include "core/data/map_file.hpp"
#include "core/data/tum.hpp"
#include "core/io/file_content.hpp"
#include "core/support/error.hpp"
#include "eval/old_names.hpp"

namespace evbench::report {
namespace {

Json segment_json(const RunRecord& run, std::size_t number, const RunSegment& segment, const ScoredTrajectory& scored,
                  const std::string& suffix, const Budget& budget, std::vector<std::string>& damage) {
  const std::string map_file = file_of_run(run.folder, "map" + suffix + ".ply");
  std::vector<Landmark> map;
  if (is_file(map_file)) attempt(damage, [&] { map = read_map(map_file); });
  std::vector<Vector3> landmarks;
  for (const std::size_t i : thinned(map.size(), budget.landmarks())) {
    landmarks.push_back(scored.alignment() * map[i].position);
  }
  return {{"from", segment.from},
          {"to", segment.to},
          {"scored", number == run.status->scored},
          {"note", scored.scores ? "" : "not aligned: " + scored.unscored},
          {"poses", scored.estimate.poses.size()},
          {"estimate", estimate_json(scored, budget.trajectory())},
          {"landmarks", vectors(landmarks, single)},
          {"landmarks_total", map.size()}};
}

Json periods_json(const RunRecord& run) {
  Json periods = Json::array();
  if (!run.status) return periods;
  const auto add = [&](const char* kind, double from, double to, const std::string& text) {
    periods.push_back({{"kind", kind}, {"from", from}, {"to", to}, {"text", text}});
  };
  for (const TimeRange& range : run.status->stationary)
    add("stationary", range.from, range.to, "the camera is at rest");
  for (const DegradedSpan& span : run.status->status.degraded) {
    add(span.reason.starts_with("lost") ? "lost" : "degraded", span.from, span.to, span.reason);
  }
  const bool is_lost = run.status->status.state == RunState::lost;
  if (is_lost && run.range && std::isfinite(run.range->to) && run.status->status.time < run.range->to) {
    add("lost", run.status->status.time, run.range->to, run.status->status.reason);
  }
  return periods;
}

/// In time order.
Json events_json(const RunRecord& run) {
  if (!run.events.is_array()) return Json::array();
  std::vector<Json> events(run.events.begin(), run.events.end());
  std::ranges::stable_sort(events, {}, [](const Json& event) { return event.value("t", 0.0); });
  return events;
}

/// The first and the last lines of a long text.
std::string shortened(const std::string& text, std::size_t most) {
  if (text.size() <= most) return text;
  const std::size_t first = text.rfind('\n', most / 2), last = text.find('\n', text.size() - most / 2);
  if (first == std::string::npos || last == std::string::npos || first >= last) return text.substr(0, most);
  return text.substr(0, first) + "\n...\n" + text.substr(last + 1);
}

Json scores_json(const RunRecord& run) {
  Json facts = Json::array();
  const Json& scores = run.final_scores;
  if (scores.is_null()) return facts;
  const auto add = [&](const char* name, const Json& value, const char* unit, double factor = 1.0) {
    if (value.is_number())
      facts.push_back({{"name", name}, {"value", fmt::format("{:.3g} {}", factor * value.get<double>(), unit)}});
  };
  add("ATE", scores["ate"]["trans_m"]["rmse"], "m");
  add("ATE", scores["ate"]["trans_percent"], "% of the path");
  add("ATE", scores["ate"]["rot_deg"]["rmse"], "deg");
  add("RPE", scores["rpe"]["trans_m"]["rmse"], "m");
  if (scores.contains("velocity")) add("velocity AUC", scores["velocity"]["rve"]["auc"], "");
  add("covered", scores["coverage"], "%", 100.0);
  if (run.realtime_factor) add("real-time factor", Json(*run.realtime_factor), "");
  return facts;
}

}  // namespace

Json ground_truth_json(const RunRecord& run, const Budget& budget) {
  const std::string path = run.folder + "/groundtruth.tum";
  if (!is_file(path)) return nullptr;
  PoseTrajectory truth;
  try {
    truth = read_tum(path);
  } catch (const InputError&) {  // run_json() says so
    return nullptr;
  }
  if (run.range) truth = truth.cut(run.range->from, run.range->to);
  return truth.empty() ? Json() : trajectory_json(truth, budget.trajectory());
}

Json run_json(const RunRecord& run, const std::string& protocol, const Budget& budget,
              std::vector<std::string>& damage) {
  Json json = {{"label", run.label},
               {"experiment", run.experiment},
               {"folder", run.folder},
               {"key", run.key},
               {"state", !run.done    ? "not run"
                         : run.status ? to_string(run.status->status.state)
                                      : "ok"},
               {"reason", !run.damage.empty() ? run.damage
                          : run.status        ? run.status->status.reason
                                              : ""},
               {"time", nullptr},
               {"alignment", ""},
               {"scores", Json::array()},
               {"segments", Json::array()},
               {"causal", nullptr},
               {"newest", nullptr},
               {"control_times", nullptr},
               {"periods", periods_json(run)},
               {"events", Json::array()},
               {"tracks", nullptr},
               {"updates", nullptr},
               {"parameters", nullptr},
               {"log", ""},
               {"config", ""}};
  if (!run.done) return json;
  attempt(damage, [&] { json["scores"] = scores_json(run); });
  attempt(damage, [&] { json["events"] = events_json(run); });
  if (run.status && run.status->status.state != RunState::ok) json["time"] = run.status->status.time;
  json["log"] = shortened(file_content(run.folder + "/log.txt").value_or(""), budget.log_characters());
  if (budget.shows_details()) json["config"] = file_content(run.folder + "/config.json").value_or("");
  const std::string truth_file = run.folder + "/groundtruth.tum";
  PoseTrajectory truth;
  if (is_file(truth_file)) attempt(damage, [&] { truth = read_tum(truth_file); });
  if (run.range) truth = truth.cut(run.range->from, run.range->to);
  ScoreOptions options;
  attempt(damage, [&] { options = protocol_of(run, protocol); });
  if (run.status) {
    for (std::size_t i = 0; i < run.status->segments.size(); ++i) {
      const bool is_scored = i + 1 == run.status->scored || run.status->segments.size() == 1;
      const std::string suffix = is_scored ? "" : fmt::format(".segment{}", i + 1);
      const ScoredTrajectory scored = read_scored(run, {.segment = suffix}, truth, options, damage);
      if (scored.estimate.poses.empty()) continue;
      json["segments"].push_back(segment_json(run, i + 1, run.status->segments[i], scored, suffix, budget, damage));
      if (!is_scored) continue;
      if (scored.scores) {
        json["alignment"] = fmt::format("{}, scale {:.4g}", scored.scores->options.alignment, scored.alignment().scale);
      }
      if (budget.shows_details()) {
        const ScoredTrajectory causal = read_scored(run, {.causal = true}, truth, options, damage);
        if (!causal.estimate.poses.empty()) json["causal"] = estimate_json(causal, budget.causal());
      }
      attempt(damage, [&] { json["newest"] = newest_json(run, scored, truth, budget); });
    }
  }
  attempt(damage, [&] { add_updates(run, budget, json); });
  attempt(damage, [&] { json["parameters"] = parameters_json(run, budget); });
  attempt(damage, [&] { json["tracks"] = tracks_json(run, budget); });
  return json;
}

}  // namespace evbench::report
