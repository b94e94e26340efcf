#include "eval/rpg_layout.hpp"

#include "core/data/tum.hpp"

namespace evbench {
namespace {

constexpr const char* kColumns = "# timestamp tx ty tz qx qy qz qw\n";

std::string alignment_of(const ScoreOptions& options) {
  const std::string& name = options.alignment;
  if (options.align_range.empty() && (name == "sim3" || name == "se3" || name == "none")) return name;
  if (options.align_range.empty() && name == "yaw") return "posyaw";
  throw InputError(
      fmt::format("rpg_trajectory_evaluation does not align by \"{}\"{}; expected none, se3, sim3 or yaw, on "
                  "all or on the first poses",
                  name, options.align_range.empty() ? "" : " on a range of time"));
}

}  // namespace

std::vector<std::pair<std::string, std::string>> rpg_layout(const PoseTrajectory& ground_truth,
                                                            const PoseTrajectory& estimate,
                                                            const ScoreOptions& options) {
  const std::string config = fmt::format("align_type: {}\nalign_num_frames: {}\n", alignment_of(options),
                                         options.align_first > 0 ? options.align_first : -1);
  std::vector<StampedPose> poses;
  for (const auto& [t, T] : estimate.poses()) poses.push_back({t + options.time_offset, T});
  return {{"stamped_groundtruth.txt", kColumns + format_tum(ground_truth)},
          {"stamped_traj_estimate.txt", kColumns + format_tum(PoseTrajectory(std::move(poses)))},
          {"eval_cfg.yaml", config}};
}

}  // namespace evbench
