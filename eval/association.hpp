#pragma once

#include <span>
#include <vector>

#include "core/data/time_range.hpp"
#include "core/motion/pose_trajectory.hpp"
#include "eval/names.hpp"

namespace evbench {

/// The ground truth with which an estimated pose is compared.
enum class AssociationMode {
  nearest,       ///< the pose that is nearest in time
  interpolated,  ///< the ground truth at the estimate's own time (position linear, rotation slerp)
};
inline constexpr NameList<2> kAssociationNames = {"nearest", "interpolated"};

struct AssociationOptions {
  AssociationMode mode = AssociationMode::nearest;
  double tolerance = 0.01;    ///< [s] largest time difference to a ground-truth pose, in both modes
  double time_offset = 0.0;   ///< [s] added to the estimate's times
  TimeRange range = {};       ///< ground truth outside is not used
  std::size_t min_pairs = 3;  ///< fewer are an error
};

/// An estimated pose and its ground truth.
struct PosePair {
  double t = 0.0;  ///< [s] time of the estimate on the ground truth's clock
  SE3 ground_truth;
  SE3 estimate;
};

struct Association {
  std::vector<PosePair> pairs;  ///< in time order
  double coverage = 0.0;        ///< see below; 0 to 1
  std::size_t unmatched = 0;    ///< poses of the estimate in no pair
};

/// Pairs the poses of two trajectories.
///
/// `nearest` is evo's rule, so that numbers are equal: each pose of the trajectory with *fewer* poses (the estimate
/// when equal) gets the pose of the other that is nearest in time, the earlier one of two equally near. A pose of the
/// longer one may be used more than once.
///
/// Throws InputError if there are fewer than `min_pairs`, with both time spans and a probable reason, if a trajectory
/// is empty, and if a pose is not finite.
Association associate(const PoseTrajectory& ground_truth, const PoseTrajectory& estimate,
                      const AssociationOptions& options);

/// The share of the ground truth's time that the associated estimate covers.
///
/// The time between two neighbouring stamps counts unless it is a gap: longer than three times the median interval of
/// that trajectory's stamps, but never if below 0.1 s and always if above 1 s. Covered is the time that counts in the
/// pairs' times *and* in the ground truth's; gaps of the ground truth are excluded from numerator and denominator. Both
/// in time order. For an estimate that starts late, ends early or has a gap the coverage is below 1 by that time.
double coverage(std::span<const double> ground_truth_times, std::span<const double> pair_times);

}  // namespace evbench
