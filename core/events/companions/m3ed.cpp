#include "core/events/companions/data_sets.hpp"
#include "core/events/companions/hdf5_poses.hpp"

namespace evbench {

Companions m3ed_companions(const EventsPlace& place) {
  Companions found;
  const auto files = place.files;
  const std::string end = "_pose_gt.h5", name = partner(place, "_data.h5", end);
  if (name.empty()) return found;
  const std::string data = name.substr(0, name.size() - end.size()) + "_data.h5";
  const bool to_right = place.right && files->has(data);
  const auto read = [=] {
    constexpr double kMicrosecond = 1e-6;
    auto poses = files->get(name, [](const std::string& path) {
      return hdf5::read_poses(path, "Cn_T_C0", "ts", kMicrosecond);  // camera now ← camera at first
    });
    SE3 T_left_camera;
    if (to_right) {
      T_left_camera = files->get(data, [](const std::string& path) {
        return hdf5::read_pose(path, "prophesee/right/calib/T_to_prophesee_left");
      });
    }
    for (StampedPose& pose : poses) pose.T = pose.T.inverse() * T_left_camera;
    return PoseFile{PoseTrajectory(std::move(poses), files->path(name)), {}};
  };
  found.ground_truth = {{name}, to_right ? "the right event camera" : "the left event camera", read};
  if (to_right && files->path(data) != place.path) found.ground_truth->names.push_back(data);
  if (place.right && !to_right) {
    found.ground_truth->remark =
        "the ground truth is that of the left event camera: no " + data + " leads to the right one";
  }
  return found;
}

}  // namespace evbench
