#include "core/data/relative_poses.hpp"

#include <fmt/format.h>

#include "core/data/pose_record.hpp"

namespace evbench {
namespace {

constexpr const char* kRelativePoseColumns = "kind t0 t1 x y z qx qy qz qw and a covariance of 36 numbers";
constexpr std::size_t kPoseColumns = 10, kAllColumns = kPoseColumns + 36;

}  // namespace

std::string format_relative_poses(std::span<const RelativePose> poses) {
  fmt::memory_buffer text;
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "# {}\n", kRelativePoseColumns);
  for (const auto& [kind, t0, t1, T, covariance] : poses) {
    fmt::format_to(out, "{} {} {} {} {} {} {} {} {} {}", kind, t0, t1, T.p.x(), T.p.y(), T.p.z(), T.q.x(), T.q.y(),
                   T.q.z(), T.q.w());
    for (const double c : covariance.reshaped<Eigen::RowMajor>()) fmt::format_to(out, " {}", c);
    text.push_back('\n');
  }
  return fmt::to_string(text);
}

std::vector<RelativePose> read_relative_poses(const std::string& path) {
  std::vector<RelativePose> poses;
  TextReader reader(path);
  while (reader.next()) {
    reader.expect_columns(kAllColumns, kRelativePoseColumns);
    RelativePose pose;
    pose.kind = reader.columns()[0];
    pose.t0 = reader.number(1, "t0");
    pose.t1 = reader.number(2, "t1");
    pose.T = {read_quaternion(reader, consecutive<4>(6)), read_vector3(reader, consecutive<3>(3), "the position")};
    for (std::size_t i = 0; i < 36; ++i) {
      pose.covariance(static_cast<Eigen::Index>(i / 6), static_cast<Eigen::Index>(i % 6)) =
          reader.number(kPoseColumns + i, "the covariance");
    }
    poses.push_back(pose);
  }
  return poses;
}

}  // namespace evbench
