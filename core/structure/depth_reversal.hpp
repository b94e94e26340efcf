#pragma once

#include "core/structure/initialiser.hpp"

namespace evbench {

/// The other explanation of a short motion: near and far exchanged, the camera moved the opposite way and turned to
/// make up for it (the Necker reversal of nearly affine views). It explains two views almost as well as the truth, and
/// least squares does not find its way from one to the other, so back-ends refine both and keep the cheaper.
///
/// With inverse depths about 1, a translation p and a small rotation vector φ move the image as −p(1 − d) − (φ_y, −φ_x)
/// for inverse depth 1 − d; d → −d, p_xy → −p_xy, φ → φ + 2 (−p_y, p_x, 0) leaves that as it is. The median depth is
/// one again.
InitialGuess reverse_depth(const InitialGuess& guess);

/// Are two motions between the same views the same, to within half a degree and 5 % of the longer translation?
bool same_motion(const SE3& a, const SE3& b);

}  // namespace evbench
