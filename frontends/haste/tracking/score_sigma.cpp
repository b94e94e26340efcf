#include "frontends/haste/tracking/score_sigma.hpp"

#include <algorithm>
#include <cmath>

namespace evbench::haste {

double ScoreSigma::next(const Scores& scores) {
  constexpr double kLeast = 0.5, kMost = 3.0;  // times the usual one
  constexpr double kPace = 0.01;               // by which an observation moves the median, up or down
  const double flatness = scores.flatness();
  if (!std::isfinite(flatness)) return kMost * usual_;
  if (flatness_ == 0.0) flatness_ = flatness;
  const double share = flatness / flatness_;
  flatness_ *= share > 1.0 ? 1.0 + kPace : 1.0 / (1.0 + kPace);
  return usual_ * std::clamp(share, kLeast, kMost);
}

}  // namespace evbench::haste
