#include "core/data/robotevt.hpp"

#include <fmt/format.h>

#include "core/data/pose_record.hpp"

namespace evbench {

PoseTrajectory read_robotevt(const std::string& path) {
  TextReader reader(path);
  std::vector<StampedPose> poses;
  while (reader.next()) {
    reader.expect_columns(13, "t r11 r12 r13 r21 r22 r23 r31 r32 r33 t1 t2 t3");
    const double t = reader.number(0, "the time");
    const SE3 T{read_rotation_matrix(reader, 1), read_vector3(reader, 10, "the position")};
    append_pose(reader, {t, T}, poses);
  }
  expect_poses(poses, path);
  return PoseTrajectory(std::move(poses), path);
}

std::string format_robotevt(const PoseTrajectory& trajectory) {
  fmt::memory_buffer text;
  const auto out = std::back_inserter(text);
  for (const auto& [t, T] : trajectory.poses()) {
    fmt::format_to(out, "{:.9f}", t);
    const Matrix3 rotation = T.R();
    for (Eigen::Index row = 0; row < 3; ++row) {
      for (Eigen::Index column = 0; column < 3; ++column) fmt::format_to(out, " {:.12f}", rotation(row, column));
    }
    fmt::format_to(out, " {:.10f} {:.10f} {:.10f}\n", T.p.x(), T.p.y(), T.p.z());
  }
  return fmt::to_string(text);
}

}  // namespace evbench
