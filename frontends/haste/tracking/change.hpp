#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "frontends/haste/tracking/hypotheses.hpp"

namespace evbench::haste {

/// How well each hypothesis (kSteps) explains the window: a higher score is better. Correlation: the mean of the
/// template, scaled to the sum one, at the window's events; difference: minus the sum of squared differences of
/// template and window, both scaled to the sum one.
struct Scores {
  std::array<double, kHypotheses> of{};

  double best() const { return *std::max_element(of.begin(), of.end()); }
  double worst() const { return *std::min_element(of.begin(), of.end()); }
  /// (best − worst) / the largest magnitude: small where all hypotheses are equally good, so that nothing is tracked. 0
  /// for scores that are all zero.
  double spread() const {
    const double largest = std::max(std::abs(best()), std::abs(worst()));
    return largest > 0.0 ? (best() - worst()) / largest : 0.0;
  }
  /// How much the paraboloid through the scores falls over √2 px from its maximum, in the direction of the smallest
  /// fall, as a share of the largest magnitude. Small at an edge, along which nothing holds a tracker. Negative where
  /// the paraboloid rises.
  double weakest_curvature() const;
  /// How uncertain the paraboloid's maximum is: minus the inverse of its curvature matrix, in shares of the largest
  /// magnitude [px²]. A disturbance of the scores' slope moves the maximum by this times the disturbance. None where
  /// there is no maximum.
  std::optional<Matrix2> flatness() const;
};

/// A tracker's change of state. The first change of a tracker marks that its window is full: tracking begins, and
/// `before` and `after` are the same state.
struct Change {
  std::int64_t tracker = -1;  ///< its id in a TrackerSet
  std::int64_t t_event = 0;   ///< [µs], of the event that led to it; after.t is half a window earlier
  TrackerState before, after;
  Scores scores;  ///< of the hypotheses around `before`
};

/// The position of the tracked point at the time after.t: half-way between the two states. (The new state alone leads
/// by half a step, because the state changes as soon as the new one is better.)
inline Vector2 midpoint(const Change& change) { return 0.5 * (change.before.position + change.after.position); }

/// The same from the scores: the maximum of the paraboloid through those of the null hypothesis and its eight
/// neighbours (least squares), no more than one pixel from the old state along each axis. The midpoint where that has
/// no maximum, and for a tracker's first change.
Vector2 refined_position(const Change& change);

}  // namespace evbench::haste
