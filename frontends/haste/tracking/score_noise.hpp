#pragma once

#include "core/geometry/pixel_noise.hpp"
#include "frontends/haste/tracking/change.hpp"

namespace evbench::haste {

/// The noise of each observation from its scores: along each direction the usual sigma times the ratio of the scores'
/// flatness there to the usual flatness. The usual flatness is a running median over all trackers, so that the scale of
/// the variants' scores does not matter. The noise is bounded, as scores do not show that a tracker has drifted.
class ScoreNoise {
 public:
  explicit ScoreNoise(double usual) : usual_(usual) {}

  /// Of the next observation.
  PixelNoise next(const Scores& scores);

 private:
  double usual_;           ///< [px]
  double flatness_ = 0.0;  ///< the usual one, a mean over all directions [px²]; 0: no observation yet
};

}  // namespace evbench::haste
