#pragma once

#include <span>
#include <vector>

#include "eval/pose_error.hpp"

namespace evbench {

/// Whose definition of errors over sub-trajectories (segments of the path) is used.
enum class SegmentRule {
  none,   ///< they are not taken
  rpg,    ///< rpg_trajectory_evaluation, Zhang and Scaramuzza 2018
  kitti,  ///< the KITTI odometry benchmark, Geiger et al. 2012
};
inline constexpr NameList<3> kSegmentRuleNames = {"none", "rpg", "kitti"};

/// In what the lengths of segments are given.
enum class LengthUnit { metres, percent };
inline constexpr NameList<2> kLengthUnitNames = {"metres", "percent"};

struct SegmentOptions {
  SegmentRule rule = SegmentRule::none;
  std::vector<double> lengths = {};  ///< > 0; empty: the rule's own, in the rule's own unit
  LengthUnit unit = LengthUnit::metres;
};

/// With the rule's own lengths where none are given: rpg 10, 20, ..., 50 % of the path, KITTI 100, 200, ..., 800 m.
SegmentOptions with_own_lengths(const SegmentOptions& options);

/// Errors over segments of one length, relative to it, one an item.
struct SegmentErrors {
  double length_m = 0.0;
  std::vector<double> trans_percent;
  std::vector<double> rot_deg_per_m;
};

/// The relative pose errors (pose_error.hpp) over segments of the ground truth's path through the compared poses:
/// - rpg: from every pose to the one at the distance that is nearest to the length, if it is within a fifth of it.
///   Fewer than two such pairs are none. Lengths in percent are cut to whole centimetres; what is then 0 is left out;
/// - kitti: from every tenth pose to the first one that is farther away than the length.
/// `path_m`: length of the whole ground truth, which percentages are of. The estimates' scale is aligned. Throws
/// InputError for a length that is not above 0.
std::vector<SegmentErrors> segment_errors(std::span<const PosePair> pairs, const SegmentOptions& options,
                                          double path_m);

}  // namespace evbench
