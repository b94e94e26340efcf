#include "bench/recordings/new_config.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <utility>
#include <vector>

#include "bench/experiment.hpp"
#include "bench/job.hpp"
#include "core/data/calib.hpp"
#include "core/data/pose_file.hpp"
#include "core/process/line_tail.hpp"
#include "core/support/error.hpp"
#include "core/support/json.hpp"

namespace evbench {
namespace {

namespace fs = std::filesystem;

/// The path as written in a config at `place`: relative where it is in the config's folder, else absolute.
std::string path_for(const std::string& path, const std::string& place) {
  fs::path absolute = fs::absolute(path).lexically_normal();
  if (!absolute.has_filename()) absolute = absolute.parent_path();  // "folder/"
  const fs::path relative = absolute.lexically_relative(fs::absolute(place).lexically_normal().parent_path());
  const bool below = !relative.empty() && *relative.begin() != "..";
  return below ? relative.generic_string() : absolute.generic_string();
}

/// The smallest of the usual sensors that has a pixel, or just that pixel's size.
std::pair<int, int> size_with(int x, int y) {
  constexpr std::array<std::pair<int, int>, 5> kUsual{{{128, 128}, {240, 180}, {346, 260}, {640, 480}, {1280, 720}}};
  const auto fits = [&](const std::pair<int, int>& size) { return x < size.first && y < size.second; };
  const auto found = std::ranges::find_if(kUsual, fits);
  return found != kUsual.end() ? *found : std::pair(x + 1, y + 1);
}

/// Lines "KEY": VALUE of an object, each with a comment before it.
class Lines {
 public:
  void add(const std::string& comment, const std::string& key, const Json& value) {
    if (!text_.empty()) text_ += ",\n";
    if (!comment.empty()) text_ += fmt::format("    // {}\n", comment);
    text_ += fmt::format("    \"{}\": {}", key, dump_json(value));
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// Sensor, calibration and ground truth, as `info` reports them.
std::string found_text(const RecordingSummary& s) {
  std::string text =
      s.info.width > 0 ? fmt::format("Sensor {}x{} pixels", s.info.width, s.info.height) : "Sensor of unknown size";
  for (const auto& [key, value] : s.info.metadata) {
    const bool reported = key == "calibration" || key == "ground truth" || key == kCameraInfoIn ||
                          key == kGroundTruthIn || key == kTopicChoice || key == "sensor size";
    if (reported) text += fmt::format("; {}: {}", key, printable(value, 200));
  }
  return text + ".";
}

/// The name for a folder of results; empty: the file's own name is used.
std::string experiment_name(const std::string& place) {
  const std::string stem = fs::path(place).stem().string();
  std::string name = stem;
  std::ranges::replace_if(
      name, [](unsigned char c) { return std::isalnum(c) == 0 && c != '_' && c != '-' && c != '.' && c != '+'; }, '_');
  if (name.starts_with('.')) name.front() = '_';
  return name == stem ? "" : name;
}

std::string text_of(const Lines& source, const std::string& recording, const std::string& name,
                    const RecordingSummary& s, bool truth) {
  return fmt::format(
      "{{\n"
      "  // {}: {}, {} events in {:.3f} s.\n"
      "  // Lines that begin like this one are comments. evbench describe config and evbench describe source "
      "recording\n"
      "  // say what else can be set.\n"
      "{}"
      "  \"source\": {{\n{}\n  }},\n"
      "  // What tracks features in the events; evbench list names others.\n"
      "  \"frontend\": {{\"type\": \"poisson\"}},\n"
      "  // The back-ends to compare; each ends tracks that it rejects; \"outliers\": false in the front-end\n"
      "  // gives all of them the same tracks.\n"
      "  \"backends\": [{{\"type\": \"gp_map\"}}, {{\"type\": \"bundle_adjustment\"}}],\n"
      "  // {}\n"
      "  \"evaluation\": {{}}\n"
      "}}\n",
      printable(recording, 200), s.info.format, s.events, s.duration(),
      name.empty() ? "" : fmt::format("  \"name\": \"{}\",\n", name), source.text(),
      truth ? "ATE and RPE after a similarity alignment (Sim(3)); evbench describe config has the other protocols."
            : "Nothing is scored, as there is no ground truth; the trajectories can be drawn by evbench figure.");
}

}  // namespace

std::string new_config(const std::string& recording, const RecordingSummary& s, const NewConfigOptions& options,
                       const std::string& place, const Plugins& plugins) {
  if (s.events == 0) throw InputError(fmt::format("{}: has no events; expected a recording of some", recording));
  if (options.calibration.empty() && !s.calibration) {
    const auto unusable =
        std::ranges::find(s.info.metadata, kUnusableCalibration, [](const auto& entry) { return entry.first; });
    const std::string why = unusable == s.info.metadata.end() ? "was found in it or beside it"
                                                              : "of it can be used (" + unusable->second + ")";
    throw InputError(
        fmt::format("{}: no calibration {}; expected one by --calibration FILE (fx fy cx cy k1 "
                    "k2 p1 p2 k3 in a line, or YAML of Kalibr, ROS or OpenCV)",
                    recording, why));
  }
  Lines source;
  source.add(found_text(s), "type", "recording");
  source.add("", fs::is_directory(recording) ? "folder" : "events", path_for(recording, place));
  if (!options.read.topic.empty()) source.add("", "topic", options.read.topic);
  if (!options.read.ground_truth_topic.empty()) source.add("", "ground_truth_topic", options.read.ground_truth_topic);
  if (!options.read.camera_info_topic.empty()) source.add("", "camera_info_topic", options.read.camera_info_topic);
  if (!options.read.columns.empty()) source.add("", "columns", options.read.columns);
  if (options.read.lenient) source.add("However many events have to be left out.", "lenient", true);
  const Camera camera =
      options.calibration.empty() ? *s.calibration : read_calib(options.calibration, s.info.width, s.info.height);
  if (!options.calibration.empty()) source.add("", "calibration", path_for(options.calibration, place));
  if (options.read.width > 0 && options.read.height > 0) {
    source.add("", "width", options.read.width);
    source.add("", "height", options.read.height);
  } else if (s.info.width <= 0 && camera.width <= 0) {
    const auto [width, height] = size_with(std::max(s.max_x, static_cast<int>(camera.pinhole.cx)),
                                           std::max(s.max_y, static_cast<int>(camera.pinhole.cy)));
    source.add(fmt::format("Nothing says the sensor's size; the events reach pixel ({}, {}). Set it to yours.", s.max_x,
                           s.max_y),
               "width", width);
    source.add("", "height", height);
  }
  PoseTrajectory poses = s.ground_truth;
  if (!options.ground_truth.empty()) poses = read_poses(options.ground_truth, {}).trajectory;
  const bool truth = !poses.empty();
  if (!options.ground_truth.empty()) source.add("", "ground_truth", path_for(options.ground_truth, place));
  double from = static_cast<double>(s.start) / 1e6, to = static_cast<double>(s.end) / 1e6;
  std::string what = "All of it, in seconds.";
  if (truth && poses.start() < to && poses.end() > from) {
    from = std::max(from, poses.start());
    to = std::min(to, poses.end());
    what = fmt::format("What events and ground truth ({}) have in common, in seconds.", poses.size());
  }
  source.add(what, "time_range", {from, to});
  const std::string text = text_of(source, recording, experiment_name(place), s, truth);
  // It must run unchanged.
  const Json json = Json::parse(text, nullptr, true, true);
  const Experiment experiment = ConfigFile(place, json, plugins).experiment({});
  make_source(experiment.runs.front().job, plugins);
  return text;
}

}  // namespace evbench
