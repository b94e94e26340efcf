#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "frontends/haste/tracking/hypotheses.hpp"

namespace evbench::haste {

/// How well each hypothesis (kSteps) explains the window, the greater the better. Correlation: the mean of the
/// template, scaled to the sum one, at the window's events; difference: minus the sum of squared differences of
/// template and window, both scaled to the sum one.
struct Scores {
  std::array<double, kHypotheses> of{};

  double best() const { return *std::max_element(of.begin(), of.end()); }
  double worst() const { return *std::min_element(of.begin(), of.end()); }
  /// (best − worst) / the largest magnitude: small where all hypotheses are as good, so that nothing is tracked. 0 for
  /// scores that are all zero.
  double spread() const {
    const double largest = std::max(std::abs(best()), std::abs(worst()));
    return largest > 0.0 ? (best() - worst()) / largest : 0.0;
  }
  /// How much the paraboloid through them falls from its top to √2 px away, along the direction along which it falls
  /// least, as a share of the largest magnitude: small before an edge, along which nothing holds a tracker. Negative
  /// where it rises.
  double weakest_curvature() const;
  /// How uncertain the place is where that paraboloid is highest: the trace of its curvatures' inverse, they being
  /// shares of the largest magnitude [px²]. What disturbs the slope of the scores moves the highest place by the
  /// inverse times that. Infinite where it has no maximum.
  double flatness() const;
};

/// What happened when a tracker changed its state. The first change of a tracker tells that its window is full: it
/// then begins to track, and `before` and `after` are the same place.
struct Change {
  std::int64_t tracker = -1;  ///< its id in a TrackerSet
  std::int64_t t_event = 0;   ///< [µs], of the event that led to it; after.t is half a window earlier
  TrackerState before, after;
  Scores scores;  ///< of the hypotheses around `before`
};

/// The place of the tracked point at the time after.t: half-way between the two states. (The new one alone leads by
/// half a step, because the state changes as soon as the new one is the better.)
inline Vector2 midpoint(const Change& change) { return 0.5 * (change.before.position + change.after.position); }

/// The same from the scores: the maximum of the paraboloid through those of the null hypothesis and its eight
/// neighbours (least squares), no more than one pixel from the old state along each axis. The midpoint where that has
/// no maximum, and for a tracker's first change.
Vector2 refined_position(const Change& change);

}  // namespace evbench::haste
