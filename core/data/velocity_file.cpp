#include "core/data/velocity_file.hpp"

#include <fmt/format.h>

#include "core/data/pose_record.hpp"

namespace evbench {
namespace {

constexpr const char* kColumns = "t wx wy wz vx vy vz";

}  // namespace

std::string format_velocities(std::span<const StampedVelocity> velocities) {
  fmt::memory_buffer text;
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "# {}\n", kColumns);
  for (const auto& [t, v] : velocities) {
    fmt::format_to(out, "{} {} {} {} {} {} {}\n", t, v[0], v[1], v[2], v[3], v[4], v[5]);
  }
  return fmt::to_string(text);
}

BodyVelocities read_velocities(const std::string& path) {
  std::vector<StampedVelocity> velocities;
  TextReader reader(path);
  while (reader.next()) {
    reader.expect_columns(7, kColumns);
    StampedVelocity read;
    read.t = reader.number(0, "the time");
    read.velocity << read_vector3(reader, consecutive<3>(1), "the angular velocity"),
        read_vector3(reader, consecutive<3>(4), "the velocity");
    if (!velocities.empty() && !(read.t > velocities.back().t)) {
      reader.fail(fmt::format("time {} s comes after {} s; expected rising times", read.t, velocities.back().t));
    }
    velocities.push_back(read);
  }
  return BodyVelocities(std::move(velocities));
}

}  // namespace evbench
