#pragma once

#include <string>

#include "eval/scores.hpp"

namespace evbench {

/// The whole estimate, aligned and on the ground truth's clock.
PoseTrajectory aligned_estimate(const PoseTrajectory& estimate, const Scores& scores);

/// The absolute error of each compared pose, as CSV: `t_s,trans_m,rot_deg,x_m,y_m,z_m`; the last three are the aligned
/// estimate's position minus the ground truth's. Numbers have the fewest digits that read back exactly.
std::string errors_csv(const Scores& scores);

}  // namespace evbench
