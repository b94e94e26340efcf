#include "bench/recordings/summary.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "bench/recordings/own_calibration.hpp"
#include "core/events/formats.hpp"
#include "core/events/time_guess.hpp"
#include "core/support/error.hpp"
#include "core/support/json.hpp"

namespace evbench {
namespace {

constexpr std::size_t kPlotWidth = 64;

std::string row(const char* name, const std::string& text) { return fmt::format("{:<14}{}\n", name, text); }

std::string sensor_text(const RecordingSummary& s) {
  if (s.info.width > 0) return fmt::format("{}x{} pixels", s.info.width, s.info.height);
  return fmt::format("unknown; events up to pixel ({}, {})", s.max_x, s.max_y);
}

std::string calibration_text(const Camera& camera) {
  const PinholeCamera& p = camera.pinhole;
  return fmt::format("fx {:.2f} fy {:.2f} cx {:.2f} cy {:.2f} px, lens model {}", p.fx, p.fy, p.cx, p.cy,
                     to_string(camera.distortion));
}

/// The text for a missing calibration or ground truth.
std::string missing_text(const RecordingSummary& s, const char* unusable_key) {
  const auto unusable = [&](const auto& entry) { return entry.first == unusable_key; };
  return std::ranges::any_of(s.info.metadata, unusable) ? "cannot be used, see below" : "none in the recording";
}

std::string ground_truth_text(const RecordingSummary& s) {
  const PoseTrajectory& truth = s.ground_truth;
  if (truth.empty()) return missing_text(s, kUnusableGroundTruth);
  return fmt::format("{} poses, {:.3f} to {:.3f} s, path {:.2f} m", truth.size(), truth.start(), truth.end(),
                     truth.path_length());
}

std::string rates_text(const RecordingSummary& s) {
  const double seconds = s.duration();
  const std::string mean = seconds > 0.0 ? rate_text(static_cast<double>(s.events) / seconds) : "-";
  auto fine = s.rates.rates();
  if (fine.size() == 1) return fmt::format("{} on average", mean);
  fine.pop_back();  // shorter than the others
  return fmt::format("{} on average, {} at most over {:g} ms", mean, rate_text(*std::ranges::max_element(fine)),
                     s.rates.width() * 1e3);
}

}  // namespace

RecordingSummary summarise(const std::string& path, const StreamOptions& options,
                           const std::function<void(std::int64_t, std::int64_t)>& progress) {
  EventStream stream(path, options);
  RecordingSummary s;
  s.files = files_of_events(path);
  for (std::vector<Event> events; stream.read(events);) {
    if (s.events == 0) s.start = events.front().t;
    s.end = events.back().t;
    s.events += static_cast<std::int64_t>(events.size());
    s.on += std::ranges::count(events, true, &Event::on);
    s.rates.add(events);
    if (progress) progress(s.events, s.end);
  }
  OwnCalibration own = own_calibration(stream.reader(), options.read.strict);
  s.calibration = own.calibration;
  if (own.ground_truth) s.ground_truth = std::move(*own.ground_truth);
  s.info = stream.info();  // with remarks on the events read just now
  if (s.info.guessed_time_unit) {
    const auto doubt = implausible_rate(s.events, static_cast<double>(s.end - s.start), *s.info.guessed_time_unit);
    if (doubt) s.info.metadata.emplace_back("remark", *doubt);
  }
  s.info.metadata.insert(s.info.metadata.end(), own.unusable.begin(), own.unusable.end());
  s.max_x = std::max(stream.max_x(), 0);
  s.max_y = std::max(stream.max_y(), 0);
  s.faults = stream.faults();
  s.large_loss = stream.large_loss();
  return s;
}

std::string format_summary(const std::string& path, const RecordingSummary& s) {
  std::string text = row("file", path);
  if (s.files.size() > 1) text += row("events in", fmt::format("{} files", s.files.size()));
  if (s.files.size() == 1 && s.files.front() != path) text += row("events in", s.files.front());
  text += row("format", s.info.format) + row("sensor", sensor_text(s));
  if (s.events == 0) {
    text += row("events", "none");
  } else {
    const double on = 100.0 * static_cast<double>(s.on) / static_cast<double>(s.events);
    text += row("events", fmt::format("{}: {} on, {} off ({:.1f} % on)", s.events, s.on, s.events - s.on, on));
    text += row("time", fmt::format("{:.6f} to {:.6f} s: {:.6f} s", static_cast<double>(s.start) * 1e-6,
                                    static_cast<double>(s.end) * 1e-6, s.duration()));
    text += row("rate", rates_text(s));
  }
  text += row("calibration", s.calibration ? calibration_text(*s.calibration) : missing_text(s, kUnusableCalibration));
  text += row("ground truth", ground_truth_text(s));
  for (const std::string& topic : s.info.topics) text += row(&topic == s.info.topics.data() ? "topics" : "", topic);
  for (const auto& [key, value] : s.info.metadata) text += row("", fmt::format("{}: {}", key, value));
  if (s.faults.empty()) text += row("oddities", "none");
  for (const auto& [kind, fault] : s.faults) {
    text += row(&kind == &s.faults.front().first ? "oddities" : "",
                fmt::format("{} {}, left out; the first: {}", fault.count, kind, fault.first));
  }
  if (s.events == 0) return text;
  return text + "\n" +
         plot_rates(s.rates.resampled(kPlotWidth), static_cast<double>(s.start) * 1e-6,
                    static_cast<double>(s.end) * 1e-6);
}

Json summary_json(const std::string& path, const RecordingSummary& s) {
  Json json = {{"file", path}, {"files", s.files}, {"format", s.info.format}};
  json["sensor"] = s.info.width > 0 ? Json{{"width", s.info.width}, {"height", s.info.height}} : Json();
  json["events"] = s.events;
  json["on"] = s.on;
  json["off"] = s.events - s.on;
  json["start_us"] = s.events > 0 ? Json(s.start) : Json();
  json["end_us"] = s.events > 0 ? Json(s.end) : Json();
  json["duration_s"] = s.duration();
  json["max_x"] = s.max_x;
  json["max_y"] = s.max_y;
  json["rates"] = {{"start_s", s.rates.start()}, {"bin_s", s.rates.width()}, {"events_per_s", s.rates.rates()}};
  json["calibration"] = Json();
  if (s.calibration) {
    const PinholeCamera& p = s.calibration->pinhole;
    const auto& k = s.calibration->coefficients;
    json["calibration"] = {{"fx", p.fx},
                           {"fy", p.fy},
                           {"cx", p.cx},
                           {"cy", p.cy},
                           {"distortion", to_string(s.calibration->distortion)},
                           {"coefficients", std::vector<double>(k.data(), k.data() + k.size())}};
  }
  json["ground_truth"] = Json();
  if (!s.ground_truth.empty()) {
    json["ground_truth"] = {{"poses", s.ground_truth.size()},
                            {"start_s", s.ground_truth.start()},
                            {"end_s", s.ground_truth.end()},
                            {"path_m", s.ground_truth.path_length()}};
  }
  json["topics"] = s.info.topics;
  json["metadata"] = Json::array();
  for (const auto& [key, value] : s.info.metadata) json["metadata"].push_back({{"key", key}, {"value", value}});
  json["oddities"] = Json::array();
  for (const auto& [kind, fault] : s.faults) {
    json["oddities"].push_back({{"what", kind}, {"count", fault.count}, {"first", fault.first}});
  }
  return json;
}

}  // namespace evbench
