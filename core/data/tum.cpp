#include "core/data/tum.hpp"

#include <fmt/format.h>

#include <charconv>

#include "core/data/pose_record.hpp"

namespace evbench {
namespace {

/// With nine decimals, or as many as it takes to read back the same time: stamps that differ must not become equal.
void append_time(double t, fmt::memory_buffer& text) {
  const std::size_t begin = text.size();
  fmt::format_to(std::back_inserter(text), "{:.9f}", t);
  double read = 0.0;
  std::from_chars(text.data() + begin, text.data() + text.size(), read);
  if (read == t) return;
  text.resize(begin);
  fmt::format_to(std::back_inserter(text), "{}", t);
}

}  // namespace

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
    append_time(t, text);
    fmt::format_to(std::back_inserter(text), " {:.10f} {:.10f} {:.10f} {:.12f} {:.12f} {:.12f} {:.12f}\n", T.p.x(),
                   T.p.y(), T.p.z(), T.q.x(), T.q.y(), T.q.z(), T.q.w());
  }
  return fmt::to_string(text);
}

}  // namespace evbench
