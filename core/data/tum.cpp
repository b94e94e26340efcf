#include "core/data/tum.hpp"

#include <fmt/format.h>

#include <charconv>

#include "core/data/pose_file.hpp"

namespace evbench {
namespace {

/// The time with nine decimals, or as many as needed to read it back: different stamps must not become equal.
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

PoseTrajectory read_tum(const std::string& path) { return read_poses(path, {.format = PoseFormat::tum}).trajectory; }

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
