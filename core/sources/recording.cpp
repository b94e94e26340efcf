#include "core/sources/recording.hpp"

#include <filesystem>

#include "core/data/calib.hpp"
#include "core/data/datasets.hpp"
#include "core/data/robotevt.hpp"
#include "core/data/tum.hpp"
#include "core/events/formats.hpp"
#include "core/support/path.hpp"

namespace evbench {
namespace {

const Registration<Source, Recording> registration("recording", "a recorded sequence: calibration and ground truth");

PoseTrajectory shifted(const PoseTrajectory& trajectory, double offset) {
  std::vector<StampedPose> poses = trajectory.poses();
  for (StampedPose& pose : poses) pose.t += offset;
  return PoseTrajectory(std::move(poses));
}

}  // namespace

void Recording::Options::declare(OptionSet& set) {
  set.add("dataset", dataset, "name of a public recording (evbench dataset list), instead of a folder");
  set.add("folder", folder, "folder with calib.txt and groundtruth.txt").path();
  set.add("events", events, "events of any format that evbench reads, instead of the folder's").path();
  set.add("calibration", calibration, "calibration file, instead of the folder's calib.txt").path();
  set.add("ground_truth", ground_truth, "ground truth file, instead of the folder's groundtruth.txt").path();
  set.add("ground_truth_format", ground_truth_format, "its format").choices({"tum", "robotevt"});
  set.add("width", width, "sensor's width [px]").range(1, 1e5);
  set.add("height", height, "sensor's height [px]").range(1, 1e5);
  set.add("distortion", distortion, "lens model of the calibration")
      .choices({"none", "radial_tangential", "equidistant"});
  set.add("time_range", time_range, "part of the sequence that is used, [from, to] [s]; empty: the ground truth's")
      .size(2);
  set.add("time_offset", time_offset, "added to the ground truth's times to get the sequence's [s]");
}

Recording::Recording(const Options& options, const SourceContext& context) : place_(context.place) {
  if (!options.dataset.empty() && !options.folder.empty()) {
    throw InputError(fmt::format("{}: dataset and folder are given; expected one of them", place_));
  }
  std::string folder = options.folder.empty() ? "" : resolve_path(options.folder, context.folder);
  if (!options.dataset.empty()) folder = existing_dataset_folder(options.dataset, place_ + ".dataset");
  events_ = options.events.empty() ? folder : resolve_path(options.events, context.folder);
  Options resolved = options;
  if (!options.calibration.empty()) resolved.calibration = resolve_path(options.calibration, context.folder);
  if (!options.ground_truth.empty()) resolved.ground_truth = resolve_path(options.ground_truth, context.folder);
  read_camera(resolved, folder);
  read_ground_truth(resolved, folder);
  set_time_range(options.time_range);
}

std::unique_ptr<EventReader> Recording::events() const {
  if (events_.empty()) return nullptr;
  const std::string cache = events_ + "/events.evb";
  ReadOptions options;
  options.width = camera_.width;
  options.height = camera_.height;
  return open_events(std::filesystem::exists(cache) ? cache : events_, options);
}

void Recording::read_camera(const Options& options, const std::string& folder) {
  if (options.calibration.empty() && folder.empty()) {
    throw InputError(fmt::format("{}: neither folder nor calibration is given; expected one of them", place_));
  }
  const std::string path = options.calibration.empty() ? folder + "/calib.txt" : options.calibration;
  camera_ = read_calib(path, options.width, options.height, parse_distortion_model(options.distortion));
  files_.push_back(path);
}

void Recording::read_ground_truth(const Options& options, const std::string& folder) {
  std::string path = options.ground_truth;
  if (path.empty()) {  // the folder's own may be missing, one that is named may not
    const std::string usual = folder + "/groundtruth.txt";
    if (!folder.empty() && std::filesystem::exists(usual)) path = usual;
  }
  if (path.empty()) {
    remarks_.push_back("no ground truth: the run can't be scored");
    return;
  }
  const PoseTrajectory read = options.ground_truth_format == "tum" ? read_tum(path) : read_robotevt(path);
  ground_truth_ = shifted(read, options.time_offset);
  files_.push_back(path);
}

void Recording::set_time_range(const std::vector<double>& range) {
  if (range.empty() && ground_truth_.empty()) {
    throw InputError(fmt::format("{}: without ground truth, time_range must be given: [from, to] in seconds", place_));
  }
  range_ = range.empty() ? TimeRange{ground_truth_.start(), ground_truth_.end()} : TimeRange{range[0], range[1]};
  if (range_.from > range_.to || (!range.empty() && range_.from == range_.to)) {
    throw InputError(fmt::format("{}.time_range: is {} to {} s; expected from < to", place_, range_.from, range_.to));
  }
  if (ground_truth_.empty()) return;
  const double start = ground_truth_.start(), end = ground_truth_.end();
  if (range_.to < start || range_.from > end) {
    throw InputError(
        fmt::format("{}.time_range: {} to {} s does not meet the ground truth, which goes from {:.3f} to {:.3f} s",
                    place_, range_.from, range_.to, start, end));
  }
  if (range_.from < start || range_.to > end) {
    remarks_.push_back(fmt::format("the ground truth covers {:.3f} to {:.3f} s of {:.3f} to {:.3f} s", start, end,
                                   range_.from, range_.to));
  }
}

}  // namespace evbench
