#pragma once

#include "frontends/haste/tracking/change.hpp"

namespace evbench::haste {

/// How well each observation is known, by the scores that led to it: its standard deviation is to the usual one as the
/// flatness of its scores to the usual flatness, a running median over all trackers, so that what the variants' scores
/// are like does not matter. Bounded, as scores tell nothing of a tracker that has slipped.
class ScoreSigma {
 public:
  explicit ScoreSigma(double usual) : usual_(usual) {}

  /// [px], of the next observation.
  double next(const Scores& scores);

 private:
  double usual_;           ///< [px]
  double flatness_ = 0.0;  ///< the usual one [px²]; 0: nothing was seen yet
};

}  // namespace evbench::haste
