#pragma once

#include <optional>
#include <utility>

#include "backends/gp_map/estimate.hpp"
#include "backends/gp_map/modules/feature_prediction.hpp"
#include "backends/gp_map/modules/map_check.hpp"
#include "backends/gp_map/modules/recent_motion.hpp"
#include "backends/gp_map/observation_follower.hpp"
#include "backends/gp_map/options.hpp"

namespace evbench::gp_map {

/// One map: its estimate and the modules that work on it. A module gets the estimate and the table of tracks, and sees
/// no other module.
struct Map {
  /// `first`: the problem of an initial map.
  Map(FactorGraph first, const Options& options, Counters& counters)
      : estimate(std::move(first), SmootherOptions{.lag = options.lag}, options.health.min_landmarks,
                 options.map.tentative, counters),
        triangulation(options.map, options.sigma_scale),
        leverage(options.leverage),
        outliers(options.outliers),
        track_noise(options.track_noise, options.learn.memory),
        prior(options.learn),
        relaxation(options.relaxation, options.learn.window, estimate.graph().qc),
        search(options.search, estimate.graph().states.front().t),
        reassociation(options.reassociation, options.sigma_scale),
        recent(options.learn.prior == LearnPrior::never
                   ? std::nullopt
                   : std::optional<RecentPrior>(std::in_place, options.learn.window, options.learn.memory,
                                                estimate.graph().qc)),
        next_learning(estimate.graph().states.front().t + options.learn.reach) {}

  Estimate estimate;
  LandmarkTriangulation triangulation;
  LeverageBound leverage;
  OutlierRejection outliers;
  TrackNoise track_noise;
  MotionPrior prior;
  PriorRelaxation relaxation;
  HypothesisSearch search;
  MapCheck check;
  Reassociation reassociation;
  FeaturePrediction prediction;
  RecentMotion recent;           ///< smoothed for causal poses
  ObservationFollower follower;  ///< between two states
  double next_learning;          ///< [s] time of the next smoothed estimates of prior and noise
};

}  // namespace evbench::gp_map
