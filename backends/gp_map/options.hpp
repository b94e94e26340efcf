#pragma once

#include <vector>

#include "backends/gp_map/modules/hypothesis_search.hpp"
#include "backends/gp_map/modules/landmark_triangulation.hpp"
#include "backends/gp_map/modules/leverage_bound.hpp"
#include "backends/gp_map/modules/map_validation.hpp"
#include "backends/gp_map/modules/motion_prior.hpp"
#include "backends/gp_map/modules/outlier_rejection.hpp"
#include "backends/gp_map/modules/prior_relaxation.hpp"
#include "backends/gp_map/modules/reassociation.hpp"
#include "backends/gp_map/modules/state_placement.hpp"
#include "backends/gp_map/modules/track_noise.hpp"
#include "backends/gp_map/smoother.hpp"
#include "core/plugin/options.hpp"
#include "core/smoother/robust_loss.hpp"
#include "core/structure/initialiser.hpp"

namespace evbench::gp_map {

/// What the motion between control states is expected to be (core/motion/motion_prior.hpp).
enum class PriorKind { wnoa, singer };

/// When too few landmarks are seen.
struct HealthOptions {
  int min_landmarks = 6;
  int lost_landmarks = 3;

  void declare(OptionSet& set);
};

struct Options {
  PlacementOptions placement;
  PriorKind prior = PriorKind::wnoa;
  double prior_rate = 40.0;
  std::vector<double> qc = {1.0, 1.0, 1.0, 1.0, 1.0, 1.0};
  double qc_scale = 1.0;
  RobustLoss::Kind loss = RobustLoss::Kind::cauchy;
  double loss_width = 2.0;
  double sigma_scale = 1.0;
  LearningOptions learn;
  InitialiserOptions initialiser{.two_view = {.max_iterations = 200, .min_parallax_deg = 0.0}};  ///< more views decide
  double max_initial_error = 2.0;
  double max_initial_uncertainty = 0.35;
  MapOptions map;
  LeverageOptions leverage;
  OutlierOptions outliers;
  TrackNoiseOptions track_noise;
  RelaxationOptions relaxation;
  SearchOptions search;
  ReassociationOptions reassociation;
  ValidationOptions validation;
  HealthOptions health;
  double lag = 0.0;
  bool per_observation = false;
  int final_iterations = 30;

  void declare(OptionSet& set);
};

}  // namespace evbench::gp_map
