#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/motion/pose_trajectory.hpp"
#include "eval/scores.hpp"

namespace evbench {

/// A result folder of rpg_trajectory_evaluation, files by name: stamped_groundtruth.txt and stamped_traj_estimate.txt
/// (`timestamp tx ty tz qx qy qz qw`, the unaligned estimate, on the ground truth's clock) and eval_cfg.yaml with the
/// alignment. Throws InputError for an alignment that this tool does not have: it has none, se3, sim3 and yaw, on all
/// or on the first poses.
std::vector<std::pair<std::string, std::string>> rpg_layout(const PoseTrajectory& ground_truth,
                                                            const PoseTrajectory& estimate,
                                                            const ScoreOptions& options);

}  // namespace evbench
