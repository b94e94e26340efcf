#pragma once

#include <span>
#include <vector>

#include "core/data/time_range.hpp"
#include "core/motion/pose_trajectory.hpp"
#include "eval/names.hpp"

namespace evbench {

/// Which ground truth an estimated pose is compared with.
enum class AssociationMode {
  nearest,       ///< the pose that is nearest in time
  interpolated,  ///< the ground truth at the estimate's own time (position linear, rotation slerp)
};
inline constexpr NameList<2> kAssociationNames = {"nearest", "interpolated"};

struct AssociationOptions {
  AssociationMode mode = AssociationMode::nearest;
  double tolerance = 0.01;    ///< [s] no ground-truth pose this near to the estimate's time: no pair. In both modes.
  double time_offset = 0.0;   ///< [s] added to the estimate's times
  TimeRange range = {};       ///< ground truth outside is not used
  std::size_t min_pairs = 3;  ///< fewer are an error
};

/// An estimated pose and the ground truth that it is compared with.
struct PosePair {
  double t = 0.0;  ///< [s] time of the estimate on the ground truth's clock
  SE3 ground_truth;
  SE3 estimate;
};

struct Association {
  std::vector<PosePair> pairs;  ///< in time order
  double coverage = 0.0;        ///< see below; 0 to 1
  std::size_t unmatched = 0;    ///< poses of the estimate that are in no pair
};

/// Pairs the poses of two trajectories.
///
/// `nearest` is evo's rule, so that numbers are equal: each pose of the trajectory with *fewer* poses (the estimate
/// when equal) gets the pose of the other that is nearest in time, the earlier one of two equally near. A pose of the
/// longer one may be used more than once.
///
/// Throws InputError when there are fewer than `min_pairs`, with both time spans and a guess at the reason, when a
/// trajectory is empty, and when a pose is not finite.
Association associate(const PoseTrajectory& ground_truth, const PoseTrajectory& estimate,
                      const AssociationOptions& options);

/// The share of the ground truth's time that the associated estimate covers.
///
/// The time between two neighbouring stamps counts unless it is a hole: longer than three times the median distance of
/// that trajectory's stamps, but never when below 0.1 s and always when above 1 s. Covered is what counts in the pairs'
/// times *and* in the ground truth's (holes of the ground truth, where nothing can be compared, are taken from
/// numerator and denominator). Both in time order. An estimate that ends early, starts late, or has a hole is below 1
/// by that time.
double coverage(std::span<const double> ground_truth_times, std::span<const double> pair_times);

}  // namespace evbench
