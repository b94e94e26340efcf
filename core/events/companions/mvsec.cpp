#include "core/data/calibration_fields.hpp"
#include "core/events/companions/data_sets.hpp"
#include "core/events/companions/hdf5_poses.hpp"

namespace evbench {
namespace {

/// Kalibr's calibrations; if some are of the events' scenario, only those: outdoor_day of outdoor_day1_data.hdf5.
std::vector<std::string> find_chains(const EventsPlace& place) {
  const std::string before = "camchain-imucam-", end = ".yaml", sequence = place.name_before("_data.hdf5");
  const auto all = place.files->matching("camchain-imucam*.yaml");
  std::vector<std::string> own;
  for (const std::string& name : all) {
    if (!name.starts_with(before)) continue;
    const std::string scenario = name.substr(before.size(), name.size() - before.size() - end.size());
    if (!scenario.empty() && sequence.starts_with(scenario)) own.push_back(name);
  }
  return own.empty() ? all : own;
}

}  // namespace

Companions mvsec_companions(const EventsPlace& place) {
  Companions found;
  const auto files = place.files;
  const std::string camera = place.right ? "cam1" : "cam0";
  const auto chains = find_chains(place);
  const auto read_chain = [=] {
    return files->get(only(*files, chains), [](const std::string& path) { return Field::read_yaml(path); });
  };
  if (!chains.empty()) {
    const auto read = [=](int, int) { return kalibr_camera(read_chain().at(camera)); };
    found.calibration = {chains, camera + " of a Kalibr calibration", read};
  }
  const std::string name = partner(place, "_data.hdf5", "_gt.hdf5");
  if (name.empty()) return found;
  const auto read_left = [=] {
    return files->get(name, [](const std::string& path) {
      return hdf5::read_poses(path, "davis/left/pose", "davis/left/pose_ts", 1.0);
    });
  };
  if (place.right && !chains.empty()) {
    const auto read = [=] {
      const SE3 T_left_right = matrix_pose(read_chain().at("cam1").at("T_cn_cnm1")).inverse();
      auto poses = read_left();
      for (StampedPose& pose : poses) pose.T = pose.T * T_left_right;
      return PoseFile{PoseTrajectory(std::move(poses), files->path(name)), {}};
    };
    std::vector<std::string> names = chains;
    names.insert(names.begin(), name);
    found.ground_truth = {std::move(names), "the right camera", read};
  } else {
    const auto read = [=] { return PoseFile{PoseTrajectory(read_left(), files->path(name)), {}}; };
    found.ground_truth = {{name}, "the left camera", read};
    if (place.right) {
      found.ground_truth->remark =
          "the ground truth is that of the left camera: no camchain-imucam*.yaml leads to the right one";
    }
  }
  return found;
}

}  // namespace evbench
