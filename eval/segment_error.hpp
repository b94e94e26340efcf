#pragma once

#include <span>
#include <vector>

#include "eval/pose_error.hpp"

namespace evbench {

/// Definition of errors over sub-trajectories (segments of the path).
enum class SegmentRule {
  none,   ///< not computed
  rpg,    ///< rpg_trajectory_evaluation, Zhang and Scaramuzza 2018
  kitti,  ///< the KITTI odometry benchmark, Geiger et al. 2012
};
inline constexpr NameList<3> kSegmentRuleNames = {"none", "rpg", "kitti"};

/// Unit of the lengths of segments.
enum class LengthUnit { metres, percent };
inline constexpr NameList<2> kLengthUnitNames = {"metres", "percent"};

struct SegmentOptions {
  SegmentRule rule = SegmentRule::none;
  std::vector<double> lengths = {};  ///< > 0; empty: the rule's own, in the rule's own unit
  LengthUnit unit = LengthUnit::metres;
};

/// Fills in the rule's own lengths if none are given: rpg 10, 20, ..., 50 % of the path, KITTI 100, 200, ..., 800 m.
SegmentOptions with_own_lengths(const SegmentOptions& options);

/// Errors over segments of one length, relative to it, one per segment.
struct SegmentErrors {
  double length_m = 0.0;
  std::vector<double> trans_percent;
  std::vector<double> rot_deg_per_m;
};

/// Relative pose errors (pose_error.hpp) over segments of the ground truth's path through the compared poses:
/// - rpg: from every pose to the one whose distance is nearest to the length, if it is within a fifth of it. Fewer than
///   two such pairs count as none. Lengths in percent are truncated to whole centimetres; lengths of 0 are left out;
/// - kitti: from every tenth pose to the first one whose distance is larger than the length.
/// `path_m`: length of the whole ground truth, the base of percentages. The estimates' scale is aligned. Throws
/// InputError for a length that is not above 0.
std::vector<SegmentErrors> segment_errors(std::span<const PosePair> pairs, const SegmentOptions& options,
                                          double path_m);

}  // namespace evbench
