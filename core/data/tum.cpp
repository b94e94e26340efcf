#include "core/data/tum.hpp"

#include <fmt/format.h>

#include "core/data/pose_record.hpp"
#include "core/support/atomic_file.hpp"

namespace evbench {

PoseTrajectory read_tum(const std::string& path, double time_unit) {
  TextReader reader(path);
  std::vector<StampedPose> poses;
  while (reader.next()) {
    reader.expect_columns(8, "t px py pz qx qy qz qw");
    const double t = time_unit * reader.number(0, "the time");
    const SE3 T{read_quaternion(reader, 4), read_vector3(reader, 1, "the position")};
    append_pose(reader, {t, T}, poses);
  }
  expect_poses(poses, path);
  return PoseTrajectory(std::move(poses), path);
}

std::string format_tum(const PoseTrajectory& trajectory) {
  fmt::memory_buffer text;
  for (const auto& [t, T] : trajectory.poses()) {
    fmt::format_to(std::back_inserter(text), "{:.9f} {:.10f} {:.10f} {:.10f} {:.12f} {:.12f} {:.12f} {:.12f}\n", t,
                   T.p.x(), T.p.y(), T.p.z(), T.q.x(), T.q.y(), T.q.z(), T.q.w());
  }
  return fmt::to_string(text);
}

void write_tum(const std::string& path, const PoseTrajectory& trajectory) { write_file(path, format_tum(trajectory)); }

}  // namespace evbench
