#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/data/track.hpp"
#include "core/motion/gp_interval.hpp"

namespace evbench {

// What front-end and back-end tell one another. Both only ever see these two values, so that they may run in one thread
// or in two.

/// What a front-end hands over at one exchange: everything that happened to its tracks since the one before.
struct TrackBatch {
  std::vector<TrackObservation> observations;  ///< in time order, later than the last batch's `until`
  /// In time order. A track that is neither observed nor ended is where it was: nothing moved enough to be seen.
  std::vector<TrackEnd> ended;
  /// [s] Everything up to here has been seen: this batch holds nothing later, the next one nothing that is not later.
  double until = 0.0;
  /// [s] The data have been looked at up to here, which is when this batch is known. Later than `until` for a front-end
  /// whose observations stand for times that have passed; none: `until`.
  std::optional<double> seen = {};

  double known_at() const { return seen.value_or(until); }
};

/// Goes through observations and ends, each in time order, as they happened: a track that is observed after its end
/// lives again. An end at the time of an observation comes after it.
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

/// Where the estimate stands at an exchange. Worse is larger.
enum class TrackingState {
  no_map,          ///< not enough has been seen for an initial map; or one was wrong, of which no causal pose was told
  tracking,        ///< observations determine the motion
  stationary,  ///< tracks are alive and nothing moves: an event camera at rest sees nothing
  degraded,        ///< too little is seen: a motion model carries the estimate
  lost,            ///< it was carried for longer than the patience, or can't go on; observations are no longer used
};
std::string to_string(TrackingState state);

/// Where the image of a landmark is expected.
struct ExpectedFeature {
  TrackId track = 0;
  Vector3 position = Vector3::Zero();        ///< of the landmark, world frame: to predict it at other poses
  Vector2 pixel = Vector2::Zero();           ///< [px], raw for a front-end, undistorted from a back-end
  Matrix2 covariance = Matrix2::Identity();  ///< of the prediction [px²], an observation's own noise not included
};

/// What a back-end hands back.
struct Feedback {
  double t = 0.0;  ///< [s], the time it stands for: what was observed up to here is in it, nothing later
  TrackingState state = TrackingState::no_map;
  std::optional<ControlState> newest;  ///< pose and velocity at newest->t ≤ t: extrapolate to predict
  std::optional<Matrix12> covariance;  ///< of (δpose, δvelocity) of `newest`, T ← T Exp(δpose)
  std::vector<TrackId> outliers;       ///< tracks dropped as outliers since the last feedback
  /// Landmarks in view, predicted at t: those of live tracks and those that were seen before. A front-end that finds
  /// one of these again goes on with its track.
  std::vector<ExpectedFeature> expected;
  /// Which world frame `newest` and `expected` are in: another one after a loss, and the earlier one again once the
  /// camera has been found in it. Set by the harness. After `no_map` the same number may stand for another frame: what
  /// was known in it is void.
  std::size_t world = 0;
};

/// What of the feedback a front-end makes use of: the rest is not computed. None: the back-end is not asked at all, and
/// every back-end gets the identical tracks.
struct FeedbackNeeds {
  bool any = false;         ///< state, newest, outliers
  bool covariance = false;  ///< with any
  bool expected = false;    ///< with any
};

}  // namespace evbench
