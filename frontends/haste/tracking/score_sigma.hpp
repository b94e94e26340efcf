#pragma once

#include "frontends/haste/tracking/change.hpp"

namespace evbench::haste {

/// The standard deviation of each observation from its scores: the usual sigma times the ratio of the scores' flatness
/// to the usual flatness. The usual flatness is a running median over all trackers, so that the scale of the variants'
/// scores does not matter. The sigma is bounded, as scores do not show that a tracker has drifted.
class ScoreSigma {
 public:
  explicit ScoreSigma(double usual) : usual_(usual) {}

  /// The standard deviation of the next observation [px].
  double next(const Scores& scores);

 private:
  double usual_;           ///< [px]
  double flatness_ = 0.0;  ///< the usual one [px²]; 0: no observation yet
};

}  // namespace evbench::haste
