#include "core/data/robotevt.hpp"

#include <fmt/format.h>

namespace evbench {

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
