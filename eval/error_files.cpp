#include "eval/error_files.hpp"

#include <fmt/format.h>

namespace evbench {

PoseTrajectory aligned_estimate(const PoseTrajectory& estimate, const Scores& scores) {
  std::vector<StampedPose> poses;
  for (const auto& [t, T] : estimate.poses()) {
    poses.push_back({t + scores.options.time_offset, scores.alignment.transform * T});
  }
  return PoseTrajectory(std::move(poses));
}

std::string errors_csv(const Scores& scores) {
  const PoseErrors errors = absolute_errors(scores.compared);
  std::string text = "t_s,trans_m,rot_deg,x_m,y_m,z_m\n";
  for (std::size_t i = 0; i < scores.compared.size(); ++i) {
    const PosePair& pair = scores.compared[i];
    const Vector3 error = pair.estimate.p - pair.ground_truth.p;
    text += fmt::format("{},{},{},{},{},{}\n", pair.t, errors.trans_m[i], errors.rot_deg[i], error.x(), error.y(),
                        error.z());
  }
  return text;
}

}  // namespace evbench
