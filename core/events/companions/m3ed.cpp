#include "core/events/companions/data_sets.hpp"
#include "core/events/companions/hdf5_poses.hpp"

namespace evbench {

Companions m3ed_companions(const EventsPlace& place) {
  Companions found;
  const std::string name = partner(place, "_data.h5", "_pose_gt.h5");
  if (name.empty()) return found;
  const auto read = [place, name] {
    constexpr double kMicrosecond = 1e-6;
    auto poses = place.files->get(name, [](const std::string& path) {
      return hdf5::read_poses(path, "Cn_T_C0", "ts", kMicrosecond);  // camera now ← camera at first
    });
    SE3 T_left_camera;
    if (place.right)
      T_left_camera = hdf5::read_pose(hdf5::File(place.path), "prophesee/right/calib/T_to_prophesee_left");
    for (StampedPose& pose : poses) pose.T = pose.T.inverse() * T_left_camera;
    return PoseTrajectory(std::move(poses), place.files->path(name));
  };
  found.ground_truth = {{name}, place.right ? "the right event camera" : "the left event camera", read};
  return found;
}

}  // namespace evbench
