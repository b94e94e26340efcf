#pragma once

#include <vector>

#include "backends/gp_map/robust_loss.hpp"
#include "core/plugin/options.hpp"
#include "core/structure/initialiser.hpp"
#include "core/structure/triangulation.hpp"

namespace evbench::gp_map {

/// When a control state is placed.
struct PlacementOptions {
  enum class Rule { rate, observations, motion, prediction } rule = Rule::prediction;
  double rate = 20.0;
  int observations = 100;
  double motion = 2.0;
  double deviation = 3.0;
  double min_spacing = 0.005, max_spacing = 0.05;

  void declare(OptionSet& set);
};

/// When tracks become landmarks, and when they are dropped.
struct MapOptions {
  TriangulationOptions triangulation;
  int min_observations = 5;
  double patience = 0.0;
  double depth_sigma = 0.5;
  double outlier_threshold = 5.0;
  double leverage = 3.0;
  double search_interval = 0.15;
  int returns = 120;

  void declare(OptionSet& set);
};

/// When the prior's power spectral density is estimated from the data.
enum class LearnPrior { never, smoothed, always };

/// Parameters that are estimated from the data.
struct LearningOptions {
  LearnPrior prior = LearnPrior::smoothed;
  bool noise = true;
  double window = 0.3, memory = 3.0;
  int rounds = 6;

  void declare(OptionSet& set);
};

/// When too few landmarks are seen.
struct HealthOptions {
  int min_landmarks = 6;
  int lost_landmarks = 3;

  void declare(OptionSet& set);
};

/// Parts of the back-end that can be left out, each to measure what it is worth.
/// Whether the final estimate is to be trusted (map_validation.hpp).
struct ValidationOptions {
  bool enabled = true;
  double disagreement = 0.01;
  int iterations = 30;

  void declare(OptionSet& set);
};

struct PartsOptions {
  bool outliers = true;
  bool track_noise = true;
  bool convergence = true;
  bool relaxation = true;
  bool search = true;
  bool rejection = true;
  bool pose_jump = true;
  bool reassociations = true;
  bool reversal = true;

  void declare(OptionSet& set);
};

struct Options {
  PlacementOptions placement;
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
  HealthOptions health;
  PartsOptions parts;
  ValidationOptions validation;
  double lag = 0.0;
  bool per_observation = false;
  int final_iterations = 30;

  void declare(OptionSet& set);
};

}  // namespace evbench::gp_map
