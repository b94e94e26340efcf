#include "core/data/causal_poses.hpp"

#include <fmt/format.h>

#include "core/data/pose_record.hpp"

namespace evbench {
namespace {

constexpr const char* kColumns = "known_at t x y z qx qy qz qw";
constexpr std::size_t kWithoutVelocity = 9, kWithVelocity = 15;

Vector6 read_velocity(const TextReader& reader) {
  Vector6 velocity;
  velocity << read_vector3(reader, consecutive<3>(9), "the angular velocity"),
      read_vector3(reader, consecutive<3>(12), "the velocity");
  return velocity;
}

}  // namespace

std::string format_causal_poses(std::span<const CausalPose> poses) {
  fmt::memory_buffer text;
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "# {} [wx wy wz vx vy vz]\n", kColumns);
  for (const CausalPose& pose : poses) {
    const auto& [q, p] = pose.T;
    fmt::format_to(out, "{} {} {} {} {} {} {} {} {}", pose.known_at.value_or(pose.t), pose.t, p.x(), p.y(), p.z(),
                   q.x(), q.y(), q.z(), q.w());
    if (pose.velocity) {
      for (const double rate : *pose.velocity) fmt::format_to(out, " {}", rate);
    }
    text.push_back('\n');
  }
  return fmt::to_string(text);
}

std::vector<CausalPose> read_causal_poses(const std::string& path) {
  std::vector<CausalPose> poses;
  TextReader reader(path);
  while (reader.next()) {
    const bool moving = reader.columns().size() == kWithVelocity;
    if (!moving) reader.expect_columns(kWithoutVelocity, kColumns);
    CausalPose pose;
    pose.known_at = reader.number(0, "known_at");
    pose.t = reader.number(1, "the time");
    pose.T = {read_quaternion(reader, consecutive<4>(5)), read_vector3(reader, consecutive<3>(2), "the position")};
    if (moving) pose.velocity = read_velocity(reader);
    if (!poses.empty() && *pose.known_at < *poses.back().known_at) {
      reader.fail(fmt::format("known_at {} s comes after {} s; expected times that don't decrease", *pose.known_at,
                              *poses.back().known_at));
    }
    poses.push_back(pose);
  }
  return poses;
}

}  // namespace evbench
