#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/data/track.hpp"
#include "core/motion/gp_interval.hpp"

namespace evbench {

// The data that front-end and back-end exchange: track batches and feedback. They share nothing else, so they may run
// in one thread or in two.

/// Output of a front-end at one exchange: all observations and ended tracks since the exchange before.
struct TrackBatch {
  std::vector<TrackObservation> observations;  ///< in time order, later than the last batch's `until`
  /// In time order. A track that is neither observed nor ended is at its last position: it has not moved measurably.
  std::vector<TrackEnd> ended;
  /// [s] The batch is complete up to this time: it contains nothing later, and the next batch only later observations.
  double until = 0.0;
  /// [s] Data time at which this batch is known: the front-end has processed the data up to here. Later than `until`
  /// for a front-end with delayed observations; none: equal to `until`.
  std::optional<double> seen = {};

  double known_at() const { return seen.value_or(until); }
};

/// Visits observations and ends, each in time order, merged by time. An end at the time of an observation comes after
/// it. A track that is observed after its end is alive again.
template <class Observe, class End>
void in_time_order(std::span<const TrackObservation> observations, std::span<const TrackEnd> ended,
                   const Observe& observe, const End& end) {
  auto next = ended.begin();
  for (const TrackObservation& z : observations) {
    for (; next != ended.end() && next->t < z.t; ++next) end(*next);
    observe(z);
  }
  std::for_each(next, ended.end(), end);
}

/// State of the estimate at an exchange. Worse is larger.
enum class TrackingState {
  no_map,      ///< no initial map yet, or the initial map was rejected before any causal pose was published
  tracking,    ///< observations determine the motion
  stationary,  ///< tracks are alive and nothing moves: an event camera at rest sees nothing
  degraded,    ///< too few observations: the motion model carries the estimate
  lost,        ///< degraded for longer than the patience, or unable to continue; observations are no longer used
};
std::string to_string(TrackingState state);

/// Predicted image position of a landmark.
struct ExpectedFeature {
  TrackId track = 0;
  Vector3 position = Vector3::Zero();        ///< of the landmark, world frame; for predictions at other poses
  Vector2 pixel = Vector2::Zero();           ///< [px], raw for a front-end, undistorted from a back-end
  Matrix2 covariance = Matrix2::Identity();  ///< of the prediction [px²], without the noise of an observation
};

/// Feedback of a back-end to the front-end.
struct Feedback {
  double t = 0.0;  ///< [s], it includes all observations up to this time and nothing later
  TrackingState state = TrackingState::no_map;
  std::optional<ControlState> newest;  ///< pose and velocity at newest->t ≤ t: extrapolate to predict
  std::optional<Matrix12> covariance;  ///< of (δpose, δvelocity) of `newest`, T ← T Exp(δpose)
  std::vector<TrackId> outliers;       ///< tracks dropped as outliers since the last feedback
  /// Landmarks in view, predicted at t: of live tracks and of ended ones. A front-end that re-associates an ended one
  /// continues its track.
  std::vector<ExpectedFeature> expected;
  /// Number of the world frame of `newest` and `expected`: a new one after tracking was lost, the earlier one again
  /// after relocalisation. Set by the harness. After `no_map` the same number may denote another frame: earlier
  /// knowledge of it is void.
  std::size_t world = 0;
};

/// The parts of the feedback that a front-end uses; the others are not computed. None: the front-end gets no feedback,
/// and all back-ends get identical tracks.
struct FeedbackNeeds {
  bool any = false;         ///< state, newest, outliers
  bool covariance = false;  ///< with any
  bool expected = false;    ///< with any
};

}  // namespace evbench
