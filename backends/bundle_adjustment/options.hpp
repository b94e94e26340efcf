#pragma once

#include <string>

#include "core/structure/initialiser.hpp"

namespace evbench::bundle_adjustment {

struct Options {
  // Batches.
  double batch_duration = 0.05;      ///< [s]
  int batch_observations = 0;        ///< observations in a batch; 0: batches by duration
  double batch_motion = 0.0;         ///< [px] median motion of the tracks in a batch; 0: batches by duration
  double min_batch_duration = 0.02;  ///< [s], of batches by motion; batch_duration is then the longest
  double common_noise_px = 0.3;      ///< part of an observation's noise that all observations in a batch share
  // Map.
  InitialiserOptions initialiser;  ///< it gets the means of batches
  double min_parallax_deg = 1.0;   ///< of a new landmark
  int min_track_batches = 3;       ///< batches in which a new landmark must be seen
  double min_track_time = 0.3;     ///< [s] that these must span: over a short time, an outlier fits any motion
  double outlier_px = 2.0;         ///< a track with a larger mean reprojection error is removed
  // Solver.
  int window = 10;  ///< batches that each update optimises
  std::string loss = "cauchy";
  double loss_width = 2.4;   ///< reprojection error where the loss stops being quadratic [sigmas of the keypoint]
  bool learn_noise = true;   ///< a factor on the keypoints' sigmas is estimated from residuals
  int iterations = 10;       ///< of an update, at most
  bool global_solve = true;  ///< of everything, at the end
  int global_iterations = 25;
  // Too few landmarks.
  int min_landmarks = 6;  ///< in a batch; with fewer, the pose is predicted and the batch is degraded

  void declare(OptionSet& set);
};

}  // namespace evbench::bundle_adjustment
