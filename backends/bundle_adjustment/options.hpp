#pragma once

#include <string>

#include "core/structure/initialiser.hpp"

namespace evbench::bundle_adjustment {

struct Options {
  // Frames.
  double batch_duration = 0.05;  ///< [s]
  int batch_observations = 0;    ///< observations in a frame; 0: frames by duration
  double batch_motion = 0.0;     ///< [px] median motion of the tracks in a frame; 0: frames by duration
  double min_batch_duration = 0.02;  ///< [s], of frames by motion; batch_duration is the longest then
  double common_noise_px = 0.3;  ///< part of an observation's noise that all observations in a frame share
  // Map.
  InitialiserOptions initialiser;  ///< its window is as long as a frame: it sees frame means
  double min_parallax_deg = 1.0;   ///< of a new landmark
  int min_track_batches = 3;        ///< frames that a new landmark must be seen in
  double min_track_time = 0.3;     ///< [s] that these must span: over a short time, an outlier fits any motion
  double outlier_px = 2.0;         ///< a track with a larger mean reprojection error is removed
  // Solver.
  int window = 10;  ///< frames that each update optimises
  std::string loss = "cauchy";
  double loss_width = 2.4;   ///< reprojection error where the loss turns from quadratic [sigmas of the keypoint]
  bool learn_noise = true;   ///< the keypoints' sigmas get a factor that residuals tell
  int iterations = 10;       ///< of an update, at most
  bool global_solve = true;  ///< of everything, at the end
  int global_iterations = 25;
  // Degenerate stretches.
  int min_landmarks = 6;  ///< in a frame; with fewer, the pose is predicted and the frame degraded

  void declare(OptionSet& set);
};

}  // namespace evbench::bundle_adjustment
