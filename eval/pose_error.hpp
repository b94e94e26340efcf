#pragma once

#include <span>
#include <utility>
#include <vector>

#include "eval/association.hpp"

namespace evbench {

/// Errors of poses, one per item: translation [m] and rotation [deg, 0 to 180].
struct PoseErrors {
  std::vector<double> trans_m;
  std::vector<double> rot_deg;
};

/// Absolute trajectory error (evo's APE) of pairs whose estimates are aligned: ‖p_estimate − p_truth‖ and the angle of
/// R_estimateᵀ R_truth. Sturm et al. 2012, section IV.
PoseErrors absolute_errors(std::span<const PosePair> pairs);

/// The yaw of the rotation that turns the ground truth's orientation into the estimate's, R_estimate R_truthᵀ, about
/// the world's z axis [deg, 0 to 180]: that of the order z, y, x, as rpg_trajectory_evaluation has it.
double yaw_error_deg(const PosePair& pair);

/// Unit of the distance from the first to the second pose of a relative error.
enum class DeltaUnit {
  frames,   ///< pairs of associated poses
  seconds,  ///< the estimate's time
  metres,   ///< length of the path between the two
  degrees,  ///< all pairs: angle between the two; consecutive: sum of the angles between them
};
inline constexpr NameList<4> kDeltaUnitNames = {"frames", "seconds", "metres", "degrees"};

enum class Pairing {
  all,          ///< from every pose to the one at the distance delta (degrees: to all such poses)
  consecutive,  ///< one chain: the next pair starts where the last ended
};
inline constexpr NameList<2> kPairingNames = {"all", "consecutive"};

/// The trajectory on which delta is measured.
enum class PairSource { estimate, ground_truth };
inline constexpr NameList<2> kPairSourceNames = {"estimate", "ground_truth"};

struct RelativeOptions {
  double delta = 0.1;  ///< > 0; whole for frames; at most 180 degrees
  DeltaUnit unit = DeltaUnit::seconds;
  Pairing pairing = Pairing::all;
  double tolerance = 0.1;  ///< largest deviation from delta, relative to it; see delta_pairs
  PairSource source = PairSource::estimate;
};

/// The pairs (first, second) of a relative error, as indices. They equal those of evo (which has no seconds):
/// - frames: (i, i + delta); consecutive: i = 0, delta, 2 delta, ...
/// - seconds and metres, all: the second is the one whose distance is nearest to delta, if within the tolerance;
/// - seconds, consecutive: the same, from the last pair's second; if none is within the tolerance, from the next pose;
/// - metres, consecutive: the path is cut where it reaches delta; the part before the first cut is not used;
/// - degrees, all: every second whose angle to the first is delta within the tolerance;
/// - degrees, consecutive: the chain starts at the first pose and is cut where the summed angles reach delta.
/// The tolerance has no effect on frames and on consecutive metres and degrees.
/// Throws InputError for a delta out of range.
std::vector<std::pair<std::size_t, std::size_t>> delta_pairs(std::span<const PosePair> pairs,
                                                             const RelativeOptions& options);

/// Relative pose errors of these index pairs: translation and angle of (Q_i⁻¹ Q_j)⁻¹ (P_i⁻¹ P_j), Q the ground truth
/// and P the estimate, whose scale is aligned. Sturm et al. 2012, eq. 1.
PoseErrors relative_errors(std::span<const PosePair> pairs,
                           std::span<const std::pair<std::size_t, std::size_t>> indices);

}  // namespace evbench
