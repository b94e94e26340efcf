#pragma once

#include "core/structure/initialiser.hpp"

namespace evbench {

/// The depth-reversed structure hypothesis of a short motion: near and far exchanged, the camera translated in the
/// opposite direction and rotated to compensate (the Necker reversal of nearly affine views). It fits two views almost
/// as well as the truth, and least squares does not converge from one to the other. Back-ends therefore refine both and
/// keep the one with the lower cost.
///
/// For inverse depths 1 − d, a translation p and a small rotation vector φ move the image by −p(1 − d) − (φ_y, −φ_x).
/// d → −d, p_xy → −p_xy, φ → φ + 2 (−p_y, p_x, 0) leaves this unchanged. The result has a median depth of 1 again.
InitialGuess reverse_depth(const InitialGuess& guess);

/// Are two motions between the same views equal to within half a degree and 5 % of the longer translation?
bool same_motion(const SE3& a, const SE3& b);

}  // namespace evbench
