#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "backends/gp_map/engine/engine.hpp"
#include "backends/gp_map/factor_graph.hpp"
#include "backends/gp_map/noise_learning.hpp"
#include "backends/gp_map/observation_follower.hpp"
#include "backends/gp_map/options.hpp"
#include "backends/gp_map/prior_learning.hpp"
#include "backends/gp_map/recent_hypothesis.hpp"
#include "backends/gp_map/recent_motion.hpp"
#include "backends/gp_map/pose_jump.hpp"
#include "backends/gp_map/return_budget.hpp"
#include "backends/gp_map/aggressive_motion.hpp"

namespace evbench::gp_map {

/// All that is known by one map: the problem with its present estimate, which tracks its landmarks are, and what has
/// been learnt with it. It begins with an initial map, and goes with that should it be refuted.
struct MapEstimate {
  static constexpr double kTentative = 5.0;      ///< [s] in which all may be explained otherwise, and no track is judged
  static constexpr double kFirstLook = 0.7;  ///< [s] of data that the first look for another explanation takes
  static constexpr double kSmoothedReach = 1.0;  ///< [s] that learning with hindsight reaches back while running
  static constexpr int kPlanes = 2;          ///< on which another explanation is looked for, in turn

  /// `first`: the problem of an initial map.
  MapEstimate(FactorGraph first, const Options& options)
      : engine(std::move(first), EngineOptions{.lag = options.lag}),
        returns(options.map.returns),
        aggressive_motion(options.health.min_landmarks, options.learn.window, engine.graph().qc),
        prior(options.learn.window, options.learn.memory),
        recent(options.learn.prior == LearnPrior::never
                   ? std::nullopt
                   : std::optional<RecentPrior>(std::in_place, options.learn.window, options.learn.memory,
                                                engine.graph().qc)),
        next_smoothed_learning(engine.graph().states.front().t + kSmoothedReach),
        tentative_until(engine.graph().states.back().t + kTentative),
        next_look(engine.graph().states.front().t + kFirstLook),
        next_jump_search(engine.graph().states.back().t) {}

  /// Of a landmark: its track, and what its sigmas are multiplied by.
  struct Known {
    TrackId track = 0;
    double noise = 1.0;     ///< the track's own
    double leverage = 1.0;  ///< bounded

    double sigma_scale() const { return std::max(noise, leverage); }
  };

  // The problem.
  Engine engine;
  UpdateSummary last_update;
  ObservationFollower follower;
  std::vector<std::pair<int, Observation>> new_observations;  ///< of landmarks, not in the engine yet

  // Its landmarks.
  std::vector<Known> known;       ///< by landmark, of which a track that came back may have several
  std::vector<int> guessed;       ///< landmarks at the scene's depth, until they show parallax
  int tracks = 0;                 ///< that are landmarks now
  ReturnBudget returns;           ///< of tracks that come back to their landmarks
  std::vector<TrackId> outliers;  ///< tracks that the front-end has not been told of

  // What is learnt.
  AggressiveMotion aggressive_motion;
  PriorLearner prior;
  NoiseLearner noise;
  RecentMotion recent;                  ///< as it is told causal
  std::optional<Vector6> smoothed_qc;  ///< the newest density that has been learnt with hindsight
  double next_smoothed_learning;                ///< [s]

  // Whether it is right: reconsideration.cpp.
  double tentative_until;                       ///< [s]
  double next_look;                         ///< [s], for another explanation
  int searches = 0;                            ///< that were begun
  std::optional<HypothesisSearch> search;  ///< the look that is under way
  int pending_checks = kPlanes;                     ///< vain looks that are missing until it is trusted
  bool confirmed = false;  ///< those were made, and most tracks fitted it then, or nothing more will tell

  std::map<TrackId, Reappearance> reappeared;  ///< of late
  double next_jump_search;                      ///< [s] when these may tell that the camera is elsewhere

  // For the front-end: feedback.cpp.
  std::pair<std::size_t, std::optional<Matrix12>> newest_covariance;  ///< as of so many states
  std::optional<std::vector<TrackId>> nearly_in_view;                 ///< as of the newest state
  std::vector<TrackId> ended_landmarks;                               ///< tracks that have ended in the last batch
};

}  // namespace evbench::gp_map
