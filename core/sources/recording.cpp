#include "core/sources/recording.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "core/data/calib.hpp"
#include "core/datasets/catalogue.hpp"
#include "core/events/companions/companions.hpp"
#include "core/events/event_stream.hpp"
#include "core/events/formats.hpp"
#include "core/events/sensor_size.hpp"
#include "core/events/time_guess.hpp"
#include "core/io/path.hpp"
#include "core/plugin/registration.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

const Registration<Source, Recording> recording_registration("recording",
                                                             "a recorded sequence: calibration and ground truth");

PoseTrajectory shifted(const PoseTrajectory& trajectory, double offset) {
  std::vector<StampedPose> poses = trajectory.poses();
  for (StampedPose& pose : poses) pose.t += offset;
  return PoseTrajectory(std::move(poses));
}

/// A recording with nothing but its folder, e.g. with a file of tracks.
class NoEvents : public EventReader {
 public:
  explicit NoEvents(const ReadOptions& options) {
    info_.width = options.width;
    info_.height = options.height;
  }
  const StreamInfo& info() const override { return info_; }
  bool read(std::vector<Event>& events) override {
    events.clear();
    return false;
  }
  void seek(std::int64_t) override {}
  const Faults& faults() const override { return faults_; }

 private:
  StreamInfo info_;
  Faults faults_{"", false};
};

}  // namespace

void Recording::Options::declare(OptionSet& set) {
  set.add("dataset", dataset, "name of a public recording (evbench dataset list), instead of a folder");
  set.add("folder", folder, "a recording's folder: its events, calibration and ground truth").path();
  set.add("events", events, "events of any format that evbench reads, instead of the folder's").path();
  set.add("calibration", calibration,
          "calibration file, instead of the folder's: calib.txt (fx fy cx cy k1 k2 p1 p2 k3), YAML of Kalibr, ROS or "
          "OpenCV")
      .path();
  set.add("camera", camera, "which camera of a named calibration with several, e.g. cam1");
  set.add("ground_truth", ground_truth,
          "ground truth file, instead of the folder's: TUM, EuRoC, KITTI, RobotEvt, or named columns")
      .path();
  set.add("ground_truth_format", ground_truth_format, {kPoseFormatNames.begin(), kPoseFormatNames.end()},
          "its format, or that of groundtruth.txt; auto: from the columns' names or number");
  set.add("ground_truth_quaternion", ground_truth_quaternion,
          {kQuaternionOrderNames.begin(), kQuaternionOrderNames.end()},
          "order of its quaternion's columns; auto: from their names or the format");
  set.add("ground_truth_times", ground_truth_times, "file with its times, one a line, where it has none (KITTI)")
      .path();
  set.add("ground_truth_time_unit", ground_truth_time_unit, {kTimeUnitNames.begin(), kTimeUnitNames.end()},
          "unit of its times; auto: from the column's name, or seconds, from 1e17 on nanoseconds");
  set.add("width", width, "sensor's width, if neither recording nor calibration states it [px]; 0: 240").range(0, 1e5);
  set.add("height", height, "sensor's height, likewise [px]; 0: 180").range(0, 1e5);
  set.add("distortion", distortion, "lens model of a calibration that does not state it")
      .choices({"none", "radial_tangential", "equidistant"});
  set.add("time_range", time_range,
          "part of the sequence that is used, [from, to] [s]; empty: the ground truth's, or, without one, all events'")
      .size(2)
      .rising();
  set.require_one_of({"dataset", "folder", "events", "calibration"});
  set.add("columns", columns, "columns of a text of events or rows of HDF5, e.g. \"t_us,x,y,p\"; empty: detected");
  set.add("topic", topic, "topic of a bag or group of an HDF5 file with the events; empty: the only one, or the first");
  set.add("ground_truth_topic", ground_truth_topic,
          "topic of a bag with the ground truth poses; empty: the only one, or the event camera's by its name");
  set.add("camera_info_topic", camera_info_topic,
          "topic of a bag with the camera info; empty: the event camera's, by its size and name");
  set.add("lenient", lenient, "go on however many of the events have to be left out");
  set.add("time_offset", time_offset, "added to the ground truth's times to get the sequence's [s]");
}

Recording::Recording(const Options& options, const SourceContext& context) : place_(context.place) {
  read_options_.topic = options.topic;
  read_options_.ground_truth_topic = options.ground_truth_topic;
  read_options_.camera_info_topic = options.camera_info_topic;
  read_options_.lenient = options.lenient;
  read_options_.columns = options.columns;
  read_options_.width = options.width;
  read_options_.height = options.height;
  if ((options.width > 0) != (options.height > 0)) {
    throw InputError(fmt::format("{}: one of width and height is given; expected both or none", place_));
  }
  if (!options.dataset.empty() && !options.folder.empty()) {
    throw InputError(fmt::format("{}: dataset and folder are given; expected one of them", place_));
  }
  std::string folder = options.folder.empty() ? "" : resolve_path(options.folder, context.folder);
  if (!options.dataset.empty()) folder = existing_dataset_folder(options.dataset, place_ + ".dataset");
  events_ = options.events.empty() ? folder : resolve_path(options.events, context.folder);
  Options resolved = options;
  if (!options.calibration.empty()) resolved.calibration = resolve_path(options.calibration, context.folder);
  if (!options.ground_truth_times.empty()) {
    resolved.ground_truth_times = resolve_path(options.ground_truth_times, context.folder);
  }
  if (!options.ground_truth.empty()) resolved.ground_truth = resolve_path(options.ground_truth, context.folder);
  const auto usual = [&](const char* name, bool stated, std::string& path) {  // if the options state its format
    if (path.empty() && stated && std::filesystem::exists(folder + "/" + name)) path = folder + "/" + name;
  };
  usual("calib.txt", options.distortion != Options().distortion, resolved.calibration);
  usual("groundtruth.txt",
        options.ground_truth_format != PoseFormat::automatic || options.ground_truth_time_unit != TimeUnit::unsaid ||
            options.ground_truth_quaternion != QuaternionOrder::automatic || !options.ground_truth_times.empty(),
        resolved.ground_truth);

  Own own = find_own(resolved, folder);
  set_camera(resolved, folder, own);
  if (camera_.distortion == DistortionModel::none && options.distortion != "none") {
    remarks_.push_back("the calibration has no lens: pixels are taken to be undistorted");
  }
  set_ground_truth(resolved, own);
  set_time_range(options.time_range, own);
}

std::unique_ptr<EventReader> Recording::all_events() const {
  if (events_.empty()) return nullptr;
  ReadOptions options = read_options_;
  options.width = camera_.width;
  options.height = camera_.height;
  return open_events(events_, options);
}

std::vector<std::string> Recording::event_files() const {
  if (events_.empty() || !holds_events(events_)) return {};
  return files_of_events(events_);
}

/// Reads what the folder, or without one the file of events, contains.
Recording::Own Recording::find_own(const Options& options, const std::string& folder) {
  Own own;
  const bool find_camera = options.calibration.empty(), find_truth = options.ground_truth.empty();
  const std::string path = folder.empty() ? events_ : folder;
  if (path != events_) find_info(own);
  if (path.empty()) return own;
  if (path == folder && !std::filesystem::is_directory(folder)) return own;  // what is missing of it is reported later
  const bool has_events = holds_events(path);
  if (!has_events && !find_camera && !find_truth) return own;
  const auto reader = has_events ? open_events(path, read_options_)
                                 : with_companions(std::make_unique<NoEvents>(read_options_),
                                                   std::make_shared<const RecordingFiles>(path), read_options_);
  if (find_camera) own.camera = reader->calibration();
  if (find_truth) own.ground_truth = reader->ground_truth();
  const StreamInfo& info = reader->info();
  if (path == events_) own.info = info;
  if (info.start && info.end && info.count && info.guessed_time_unit) {
    const auto duration = static_cast<double>(*info.end) - static_cast<double>(*info.start);
    if (const auto warning = implausible_rate(*info.count, duration, *info.guessed_time_unit))
      remarks_.push_back(*warning);
  }
  for (const auto& [key, text] : info.metadata) {
    if (key == "remark" && find_truth) remarks_.push_back(text);
    if (key == kUnusableCalibration) own.unusable += (own.unusable.empty() ? "" : "; ") + text;
    const bool topic =
        key == kTopicChoice || (key == kCameraInfoIn && find_camera) || (key == kGroundTruthIn && find_truth);
    if (topic) remarks_.push_back(fmt::format("{}: {}", key, text));
  }
  files_ = reader->companion_files();
  return own;
}

/// Reads the headers of events that are not the folder's.
void Recording::find_info(Own& own) const {
  if (!events_.empty() && holds_events(events_)) own.info = open_events(events_, read_options_)->info();
}

void Recording::set_camera(const Options& options, const std::string& folder, const Own& own) {
  constexpr int kUsualWidth = 240, kUsualHeight = 180;  // DAVIS 240C, of the Event-Camera Dataset
  const bool guess = own.info.size_assumed && options.width == 0;
  const int width = guess || own.info.width <= 0 ? options.width : own.info.width;
  const int height = guess || own.info.height <= 0 ? options.height : own.info.height;
  if (!options.calibration.empty()) {
    camera_ =
        read_calib(options.calibration, width, height, parse_distortion_model(options.distortion), options.camera);
    files_.push_back(options.calibration);
  } else if (own.camera) {
    camera_ = *own.camera;
  } else {
    throw InputError(
        fmt::format("{}: no calibration is known of {}{}, e.g. {}/calib.txt: no such file; name one as "
                    "calibration",
                    place_, folder.empty() ? events_ : folder, own.unusable.empty() ? "" : " (" + own.unusable + ")",
                    folder.empty() ? std::filesystem::path(events_).parent_path().string() : folder));
  }
  const bool stated = camera_.width > 0 && camera_.height > 0;
  if (!stated) {
    const bool usual = own.info.width <= 0 || own.info.height <= 0;
    camera_.width = usual ? kUsualWidth : own.info.width;
    camera_.height = usual ? kUsualHeight : own.info.height;
  }
  check_sizes(options, own.info);
  const bool assumed = !stated || (guess && options.calibration.empty());
  if (assumed && !own.info.format.empty()) {
    size_assumption_ =
        fmt::format("nothing states the sensor's size, {}x{} pixels is assumed; source.width and source.height set it",
                    camera_.width, camera_.height);
    remarks_.push_back(size_assumption_);
  }
  const Vector2 centre(camera_.pinhole.cx, camera_.pinhole.cy);
  if (!camera_.contains(centre)) {
    throw InputError(fmt::format(
        "{}: the calibration has the principal point ({}, {}), outside the sensor of {}x{} "
        "pixels{}; expected width and height of this camera",
        place_, centre.x(), centre.y(), camera_.width, camera_.height, assumed ? ", which is assumed" : ""));
  }
}

/// Checks that recording, options and calibration are of one sensor.
void Recording::check_sizes(const Options& options, const StreamInfo& recording) const {
  const auto require = [&](const char* whose, int width, int height) {
    if (options.width == 0 || (width == options.width && height == options.height)) return;
    throw InputError(
        fmt::format("{}: width and height say a sensor of {}x{} pixels, {} one of {}x{}; expected the same", place_,
                    options.width, options.height, whose, width, height));
  };
  if (recording.width > 0 && recording.height > 0) require("the recording", recording.width, recording.height);
  require("the calibration", camera_.width, camera_.height);
  check_same_sensor(place_ + ": the calibration", camera_, recording);
}

void Recording::set_ground_truth(const Options& options, Own& own) {
  if (!options.ground_truth.empty()) {
    PoseFile file = read_poses(options.ground_truth, {.format = options.ground_truth_format,
                                                      .quaternion = options.ground_truth_quaternion,
                                                      .time_unit = options.ground_truth_time_unit,
                                                      .times = options.ground_truth_times});
    own.ground_truth = std::move(file.trajectory);
    remarks_.insert(remarks_.end(), file.remarks.begin(), file.remarks.end());
    files_.push_back(options.ground_truth);
    if (!options.ground_truth_times.empty()) files_.push_back(options.ground_truth_times);
  }
  if (own.ground_truth) {
    ground_truth_ = shifted(*own.ground_truth, options.time_offset);
  } else {
    remarks_.push_back("no ground truth: the run can't be scored");
  }
}

void Recording::set_time_range(const std::vector<double>& range, const Own& own) {
  if (range.empty() && ground_truth_.empty()) {
    range_ = time_of_events(own.info);
    return;
  }
  range_ = range.empty() ? TimeRange{ground_truth_.start(), ground_truth_.end()} : TimeRange{range[0], range[1]};
  if (ground_truth_.empty()) return;
  const double start = ground_truth_.start(), end = ground_truth_.end();
  if (range_.to < start || range_.from > end) {
    throw InputError(fmt::format("{}.time_range: {} to {} s does not meet the ground truth, whose times {}", place_,
                                 range_.from, range_.to,
                                 times_outside(start, end, range_.from, range_.to, "ground_truth_time_unit")));
  }
  if (range_.from < start || range_.to > end) {
    remarks_.push_back(fmt::format("the ground truth covers {:.3f} to {:.3f} s of {:.3f} to {:.3f} s", start, end,
                                   range_.from, range_.to));
  }
}

/// From the first event to the last, which are searched for if the file's header does not state their times.
TimeRange Recording::time_of_events(const StreamInfo& info) const {
  std::optional<std::int64_t> first = info.start, last = info.end;
  if (!first || !last) {
    if (events_.empty() || !holds_events(events_)) {
      throw InputError(
          fmt::format("{}: without ground truth and events, time_range must be given: [from, to] in seconds", place_));
    }
    EventStream stream(all_events(), events_, {.read = {.lenient = true}});
    for (std::vector<Event> events; stream.read(events);) {
      if (!first) first = events.front().t;
      last = events.back().t;
    }
  }
  if (!first || !last || *first >= *last) {
    throw InputError(fmt::format("{}: {} has no events over any time; expected a recording of some", place_, events_));
  }
  return {1e-6 * static_cast<double>(*first), 1e-6 * static_cast<double>(*last)};
}

}  // namespace evbench
