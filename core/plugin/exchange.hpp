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

/// All observations and ended tracks of one exchange since the exchange before.
template <class Pixels>
struct BatchOf {
  std::vector<ObservationOf<Pixels>> observations;  ///< in time order, later than the last batch's `until`
  /// In time order. A track that is neither observed nor ended is at its last position: it has not moved measurably.
  std::vector<TrackEnd> ended;
  /// [s] The batch is complete up to this time: it contains nothing later, and the next batch only later observations.
  double until = 0.0;
  /// [s] Data time at which this batch is known: the front-end has processed the data up to here. Later than `until`
  /// for a front-end with delayed observations; none: equal to `until`.
  std::optional<double> seen = {};

  double known_at() const { return seen.value_or(until); }
};
using TrackBatch = BatchOf<RawPixels>;                ///< the output of a front-end
using UndistortedBatch = BatchOf<UndistortedPixels>;  ///< the input of a back-end

/// Visits observations and ends, each in time order, merged by time. An end at the time of an observation comes after
/// it. A track that is observed after its end is alive again.
template <class Observations, class Observe, class End>
void in_time_order(const Observations& observations, std::span<const TrackEnd> ended, const Observe& observe,
                   const End& end) {
  auto next = ended.begin();
  for (const auto& z : observations) {
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
template <class Pixels>
struct FeatureOf {
  TrackId track = 0;
  Vector3 position = Vector3::Zero();        ///< of the landmark, world frame; for predictions at other poses
  Vector2 pixel = Vector2::Zero();           ///< [px]
  Matrix2 covariance = Matrix2::Identity();  ///< of the prediction [px²], without the noise of an observation
};
using ExpectedFeature = FeatureOf<RawPixels>;             ///< for a front-end
using UndistortedFeature = FeatureOf<UndistortedPixels>;  ///< of a back-end

/// State of an estimate at an exchange, and what it predicts.
template <class Pixels>
struct FeedbackOf {
  TrackingState state = TrackingState::no_map;
  std::optional<ControlState> newest;  ///< pose and velocity, not later than the batch: extrapolate to predict
  std::optional<Matrix12> covariance;  ///< of (δpose, δvelocity) of `newest`, T ← T Exp(δpose)
  std::vector<TrackId> outliers;       ///< tracks dropped as outliers since the last feedback
  /// Landmarks in view, predicted at the end of the batch: of live tracks and of ended ones. A front-end that
  /// re-associates an ended one continues its track.
  std::vector<FeatureOf<Pixels>> expected;
};
using BackEndFeedback = FeedbackOf<UndistortedPixels>;  ///< the answer of a back-end, in its own world

/// Feedback to a front-end: the answer of the back-end, with its time and its world.
struct Feedback : FeedbackOf<RawPixels> {
  double t = 0.0;  ///< [s], it includes all observations up to this time and nothing later
  /// Number of the world frame of `newest` and `expected`: a new one after tracking was lost, the earlier one again
  /// after relocalisation. After `no_map` the same number may denote another frame: earlier
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
