#include <fmt/format.h>

#include "core/data/calibration_fields.hpp"
#include "core/events/companions/data_sets.hpp"

namespace evbench {
namespace {

/// A pose in Basalt's JSON.
SE3 read_pose(const Field& pose) {
  const Eigen::Quaterniond q(pose.at("qw").number(), pose.at("qx").number(), pose.at("qy").number(),
                             pose.at("qz").number());
  if (!(std::abs(q.norm() - 1.0) < 1e-2)) pose.fail(fmt::format("has a quaternion of norm {}; expected 1", q.norm()));
  return {q.normalized(), Vector3(pose.at("px").number(), pose.at("py").number(), pose.at("pz").number())};
}

Camera read_camera(const Field& calibration, std::size_t index) {
  const Field camera = calibration.at("intrinsics").at(index), type = camera.at("camera_type"),
              values = camera.at("intrinsics");
  if (type.text() != "kb4") type.fail(fmt::format("is \"{}\"; expected kb4", type.text()));
  const auto several = [&](std::initializer_list<const char*> names) {
    std::vector<double> numbers;
    for (const char* name : names) numbers.push_back(values.at(name).number());
    return numbers;
  };
  const Field resolution = calibration.at("resolution").at(index);
  const std::vector<double> size = resolution.numbers(2);
  return checked_camera(values.place(), several({"fx", "fy", "cx", "cy"}), DistortionModel::equidistant,
                        several({"k1", "k2", "k3", "k4"}), checked_side(resolution.place(), size[0]),
                        checked_side(resolution.place(), size[1]));
}

/// Each sequence has either calibration A or B.
Field read_calibration(const RecordingFiles& files, const std::vector<std::string>& names) {
  return files.get(only(files, names), [](const std::string& path) { return Field::read_json(path).at("value0"); });
}

/// Where the archive of poses was unpacked: next to the events, or into a folder of its own.
std::string find_poses(const EventsPlace& place) {
  const std::string sequence = place.name_before(place.right ? "-events_right.h5" : "-events_left.h5");
  for (const std::string& name : {std::string("mocap_data.txt"), sequence + "-vi_gt_data/mocap_data.txt"}) {
    if (place.files->has(name)) return name;
  }
  return "";
}

}  // namespace

Companions tumvie_companions(const EventsPlace& place) {
  Companions found;
  const auto files = place.files;
  const auto cameras = files->matching("camera-calibration*.json"),
             markers = files->matching("mocap-imu-calibration*.json");
  const std::size_t index = place.right ? 3 : 2;
  if (!cameras.empty()) {
    const auto read = [=](int, int) { return read_camera(read_calibration(*files, cameras), index); };
    found.calibration = {
        cameras, fmt::format("camera {}, TUM-VIE's {} event camera", index, place.right ? "right" : "left"), read};
  }
  const std::string poses = find_poses(place);
  if (poses.empty()) return found;
  const auto read_markers = [=] {
    return files->get(poses, [](const std::string& path) {
      return read_poses(path, {.format = PoseFormat::tum, .time_unit = TimeUnit::microseconds});
    });
  };
  if (cameras.empty() || markers.empty()) {
    found.ground_truth = {{poses},
                          "the motion capture's markers",
                          read_markers,
                          "the ground truth is T_world_marker, of the motion capture's markers: no "
                          "camera-calibration*.json with a mocap-imu-calibration*.json leads to the camera"};
    return found;
  }
  const auto read = [=] {
    const SE3 T_imu_marker = read_pose(read_calibration(*files, markers).at("T_imu_marker")),
              T_imu_camera = read_pose(read_calibration(*files, cameras).at("T_imu_cam").at(index));
    const SE3 T_marker_camera = T_imu_marker.inverse() * T_imu_camera;
    PoseFile file = read_markers();
    std::vector<StampedPose> trajectory = std::move(file.trajectory).poses();
    for (StampedPose& pose : trajectory) pose.T = pose.T * T_marker_camera;
    file.trajectory = PoseTrajectory(std::move(trajectory));
    return file;
  };
  found.ground_truth = {{poses, markers.front(), cameras.front()}, "the event camera", read};
  return found;
}

}  // namespace evbench
