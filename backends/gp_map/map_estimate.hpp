#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "backends/gp_map/aggressive_motion.hpp"
#include "backends/gp_map/engine/engine.hpp"
#include "backends/gp_map/factor_graph.hpp"
#include "backends/gp_map/noise_learning.hpp"
#include "backends/gp_map/observation_follower.hpp"
#include "backends/gp_map/options.hpp"
#include "backends/gp_map/pose_jump.hpp"
#include "backends/gp_map/prior_learning.hpp"
#include "backends/gp_map/recent_hypothesis.hpp"
#include "backends/gp_map/recent_motion.hpp"
#include "backends/gp_map/return_budget.hpp"

namespace evbench::gp_map {

/// Everything that belongs to one map: the problem with its present estimate, the tracks of its landmarks, and the
/// estimated parameters. It begins with an initial map, and ends if that is rejected.
struct MapEstimate {
  static constexpr double kTentative = 5.0;      ///< [s] of motion in which the whole map may be replaced, and no track
                                                 ///< is rejected
  static constexpr double kFirstSearch = 0.7;    ///< [s] of data before the first hypothesis search
  static constexpr double kSmoothedReach = 1.0;  ///< [s] that smoothed re-estimation reaches back while running
  static constexpr int kPlanes = 2;              ///< plane hypotheses, searched in turn

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
        next_search(engine.graph().states.front().t + kFirstSearch),
        next_jump_search(engine.graph().states.back().t) {}

  /// A landmark's track, and the factors of its sigmas.
  struct Known {
    TrackId track = 0;
    double noise = 1.0;     ///< of the track itself
    double leverage = 1.0;  ///< bound of its leverage

    double sigma_scale() const { return std::max(noise, leverage); }
  };

  /// After the newest state was estimated. `enough`: tracks whose observations show fully that the camera moves.
  void end_step(int enough) {
    const FactorGraph& graph = engine.graph();
    const std::size_t n = graph.states.size();
    const double share = static_cast<double>(graph.intervals.back().groups().size()) / enough;
    moved += std::min(share, 1.0) * (graph.states[n - 1].t - graph.states[n - 2].t);
    ++steps;
    nearly_in_view.reset();
  }

  // The problem.
  Engine engine;
  std::size_t steps = 1;  ///< one a control state
  UpdateSummary last_update;
  ObservationFollower follower;
  std::vector<std::pair<int, Observation>> new_observations;  ///< of landmarks, not in the engine yet

  // Its landmarks.
  std::vector<Known> known;       ///< by landmark; a re-acquired track may have several
  std::vector<int> guessed;       ///< landmarks at the scene's depth, until they show parallax
  int tracks = 0;                 ///< number of tracks that are landmarks
  ReturnBudget returns;           ///< of re-acquired tracks that continue their landmarks
  std::vector<TrackId> outliers;  ///< not reported to the front-end yet

  // Estimated parameters.
  AggressiveMotion aggressive_motion;
  PriorLearner prior;
  NoiseLearner noise;
  RecentMotion recent;                 ///< smoothed for causal poses
  std::optional<Vector6> smoothed_qc;  ///< newest density of the smoothed re-estimation
  double next_smoothed_learning;       ///< [s]

  // Checks of the map: hypothesis_search.cpp.
  double moved = 0.0;                      ///< [s] that it has seen motion for: an event camera at rest sees nothing
  double next_search;                      ///< [s] of the next hypothesis search
  int searches = 0;                        ///< number of those that were begun
  std::optional<HypothesisSearch> search;  ///< in progress
  int pending_checks = kPlanes;            ///< failed searches that are missing for a confirmation
  bool confirmed = false;  ///< after these searches, when most tracks fitted it, or at the end of the data

  std::map<TrackId, Reappearance> reappeared;  ///< recent ones
  double next_jump_search;                     ///< [s] of the next test for a pose jump

  // For the front-end: feedback.cpp.
  std::pair<std::size_t, std::optional<Matrix12>> newest_covariance;  ///< in this step
  std::optional<std::vector<TrackId>> nearly_in_view;                 ///< at the newest state
  std::vector<TrackId> ended_landmarks;                               ///< tracks that have ended in the last batch
};

}  // namespace evbench::gp_map
