#pragma once

#include <span>
#include <string>

#include "core/geometry/similarity.hpp"
#include "eval/association.hpp"

namespace evbench {

/// How the estimate is aligned to the ground truth before absolute errors are computed. All but `origin` are least
/// squares on positions.
enum class AlignmentMethod {
  none,    ///< no alignment
  se3,     ///< rotation and translation (Umeyama 1991, scale 1)
  sim3,    ///< rotation, translation, scale (Umeyama 1991)
  scale,   ///< the scale of `sim3` about the estimate's origin, without rotation and translation (evo's -s without -a)
  yaw,     ///< translation and a rotation about the ground truth's z axis, which must be the direction of gravity
  origin,  ///< rotation and translation that make the first poses equal
};
inline constexpr NameList<6> kAlignmentNames = {"none", "se3", "sim3", "scale", "yaw", "origin"};

struct Alignment {
  Similarity transform;  ///< ground truth ≈ transform * estimate
  std::string note;      ///< set if the positions do not determine the transformation
};

/// Aligns on these pairs. Throws InputError for fewer than three (fewer than one for `origin`; `none` accepts any).
///
/// Degenerate motion has a defined result and a note:
/// - one of the trajectories is stationary: scale 1; the rotation is the mean of the relative orientations;
/// - all positions on a line (se3, sim3): the rotation about the line, which positions do not determine, is the one
///   that fits the orientations best; scale and translation as usual;
/// - no horizontal motion (yaw): the yaw that fits the orientations best.
Alignment align(std::span<const PosePair> pairs, AlignmentMethod method);

/// R with R R_estimate nearest to R_truth over all pairs (chordal mean): the common rotation error of all orientations.
/// If positions are nearly on a line, `align` determines the rotation about it from small deviations, and such an error
/// remains.
Eigen::Quaterniond common_rotation(std::span<const PosePair> pairs);

}  // namespace evbench
