#pragma once

#include <span>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/geometry/se3.hpp"

namespace evbench {

/// Refines a relative pose (unit translation) by Levenberg-Marquardt on the Sampson distances of matched pixels to
/// their epipolar lines, with a Huber loss of width `huber_px`. Matches with `use[i]` false are ignored. Five degrees
/// of freedom: R ← R Exp(φ), t ← the unit vector along t + B δ, with B a basis of the plane orthogonal to t.
SE3 refine_relative_pose(const SE3& T_first_second, std::span<const Vector2> first, std::span<const Vector2> second,
                         const std::vector<bool>& use, const PinholeCamera& camera, double huber_px);

}  // namespace evbench
