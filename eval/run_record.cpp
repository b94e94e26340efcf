#include "eval/run_record.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "eval/json_file.hpp"
#include "eval/old_names.hpp"
#include "eval/quantile.hpp"
#include "eval/record_reader.hpp"

namespace evbench {
namespace {

constexpr std::array kStates = {RunState::ok, RunState::degraded, RunState::lost, RunState::failed};

Json or_null(const std::optional<double>& value) { return value && std::isfinite(*value) ? Json(*value) : Json(); }

Json to_json(const TimeRange& span) { return {{"from", span.from}, {"to", span.to}}; }

Json to_json(const std::optional<StepTimes>& times) {
  if (!times) return nullptr;
  return {{"median", times->median}, {"p99", times->p99}, {"max", times->max}};
}

Json to_json(const RecordedTimes& times) {
  return {{"source_s", times.source},
          {"frontend_s", times.frontend},
          {"backend_s", times.backend},
          {"waiting_s", times.waiting},
          {"harness_s", times.harness},
          {"total_s", times.total},
          {"slowest_5s_factor", or_null(times.slowest_5s)},
          {"frontend_ms", to_json(times.frontend_ms)},
          {"backend_ms", to_json(times.backend_ms)}};
}

std::optional<StepTimes> read_step_times(const RecordReader& times, const char* key) {
  const Json& json = times.at(key);
  if (json.is_null()) return std::nullopt;
  const RecordReader reader(json, times.place() + "." + key);
  return StepTimes{reader.number("median"), reader.number("p99"), reader.number("max")};
}

RecordedTimes read_times(const RecordReader& json) {
  return {json.number_or_null("source_s").value_or(0.0),
          json.number("frontend_s"),
          json.number("backend_s"),
          json.number("waiting_s"),
          json.number("harness_s"),
          json.number("total_s"),
          json.number_or_null("slowest_5s_factor"),
          read_step_times(json, "frontend_ms"),
          read_step_times(json, "backend_ms")};
}

RunState read_state(const RecordReader& status) {
  const std::string name = status.text("state");
  for (const RunState state : kStates) {
    if (name == to_string(state)) return state;
  }
  status.fail("state", "ok, degraded, lost or failed");
}

RunStatus read_status(const RecordReader& json) {
  RunStatus result;
  result.status.state = read_state(json);
  result.status.reason = json.text_or("reason", "");
  result.status.time = json.number_or_null("time").value_or(0.0);
  for (const RecordReader& span : json.list("degraded")) {
    result.status.degraded.push_back({span.number("from"), span.number("to"), span.text_or("reason", "")});
  }
  for (const RecordReader& span : json.list("stationary")) {
    result.stationary.push_back({span.number("from"), span.number("to")});
  }
  for (const RecordReader& segment : json.list("segments")) {
    result.segments.push_back({segment.number("from"), segment.number("to"), segment.count_or_null("poses").value_or(0),
                               segment.count_or_null("landmarks").value_or(0)});
  }
  result.scored = json.count_or_null("scored_segment").value_or(0);
  result.complete = json.flag_or("complete", true);
  return result;
}

std::optional<TimeRange> read_range(const RecordReader& json) {
  const Json& range = json.at("range_s");
  if (range.is_null()) return std::nullopt;
  if (!range.is_array() || range.size() != 2 || !range[0].is_number() || !range[1].is_number()) {
    json.fail("range_s", "two times in seconds");
  }
  return TimeRange{range[0].get<double>(), range[1].get<double>()};
}

Json metrics_json(const RunRecord& record, bool scores) {
  Json json = {{"experiment", record.experiment}, {"label", record.label}};
  json["seed"] = record.seed ? Json(*record.seed) : Json();
  json["key"] = record.key.empty() ? Json() : Json(record.key);
  json["position"] = record.position ? Json(*record.position) : Json();
  if (scores) {
    json["final"] = record.final_scores;
    json["causal"] = record.causal_scores;
    json["covariance"] = record.covariance;
  }
  if (!record.final_unscored.empty()) json["final_unscored"] = record.final_unscored;
  if (!record.causal_unscored.empty()) json["causal_unscored"] = record.causal_unscored;
  json["range_s"] = record.range ? Json{record.range->from, record.range->to} : Json();
  json["runtime_s"] = or_null(record.runtime_s);
  json["data_s"] = or_null(record.data_s);
  json["realtime_factor"] = or_null(record.realtime_factor);
  if (!record.track_scores.is_null()) json["tracks"] = record.track_scores;
  json["times"] = record.times ? to_json(*record.times) : Json();
  json["peak_rss_mib"] = or_null(record.peak_rss_mib);
  json["events"] = record.events;
  json["counters"] = record.counters;
  json["status"] = record.status ? to_json(*record.status) : Json();
  return json;
}

}  // namespace

Json to_json(const RunStatus& run) {
  const Status& status = run.status;
  Json json = {{"state", to_string(status.state)}};
  json["reason"] = status.reason;
  json["time"] = status.state == RunState::ok ? Json() : or_null(status.time);
  json["complete"] = run.complete;
  json["degraded"] = Json::array();
  for (const DegradedSpan& span : status.degraded) {
    json["degraded"].push_back({{"from", span.from}, {"to", span.to}, {"reason", span.reason}});
  }
  json["stationary"] = Json::array();
  for (const TimeRange& span : run.stationary) json["stationary"].push_back(to_json(span));
  json["segments"] = Json::array();
  for (const RunSegment& segment : run.segments) {
    json["segments"].push_back(
        {{"from", segment.from}, {"to", segment.to}, {"poses", segment.poses}, {"landmarks", segment.landmarks}});
  }
  json["scored_segment"] = run.scored > 0 ? Json(run.scored) : Json();
  return json;
}

std::optional<StepTimes> step_times(std::vector<double> seconds) {
  if (seconds.empty()) return std::nullopt;
  std::ranges::sort(seconds);
  return StepTimes{1e3 * quantile(seconds, 0.5), 1e3 * quantile(seconds, 0.99), 1e3 * seconds.back()};
}

Json to_json_without_scores(const RunRecord& record) { return metrics_json(record, false); }

Json to_json(const RunRecord& record) { return metrics_json(record, true); }

RunRecord read_record(const Json& written, const std::string& place) {
  Json metrics = written;
  rename_old_metrics(metrics);
  const RecordReader json(metrics, place);
  RunRecord record;
  for (const auto& [key, scores] : {std::pair{"final", &record.final_scores}, {"causal", &record.causal_scores}}) {
    if (!metrics.contains(key) || !(json.at(key).is_object() || json.at(key).is_null())) {
      throw InputError(fmt::format("{}: \"{}\" is missing; expected scores or null", place, key));
    }
    *scores = json.at(key);
  }
  record.covariance = json.at("covariance");
  record.track_scores = json.at("tracks");
  record.events = json.at("events");
  record.counters = json.at("counters");
  record.experiment = json.text("experiment");
  record.label = json.text("label");
  record.seed = json.count_or_null("seed");
  record.key = json.text_or("key", "");
  record.position = json.count_or_null("position");
  record.final_unscored = json.text_or("final_unscored", "");
  record.causal_unscored = json.text_or("causal_unscored", "");
  record.range = read_range(json);
  record.runtime_s = json.number_or_null("runtime_s");
  record.data_s = json.number_or_null("data_s");
  record.realtime_factor = json.number_or_null("realtime_factor");
  if (const Json& times = json.at("times"); !times.is_null()) {
    record.times = read_times(RecordReader(times, place + ": times"));
  }
  record.peak_rss_mib = json.number_or_null("peak_rss_mib");
  if (const Json& status = json.at("status"); !status.is_null()) {
    record.status = read_status(RecordReader(status, place + ": status"));
  }
  return record;
}

RunRecord read_record(const std::string& folder) {
  const std::string path = folder + "/metrics.json";
  RunRecord record = read_record(read_json_file(path), path);
  record.folder = folder;
  const std::string config = folder + "/config.json";
  if (std::filesystem::exists(config)) {
    Json settings = read_json_file(config);
    rename_old_keys(settings);
    record.settings = settings_of(settings);
  }
  return record;
}

}  // namespace evbench
