#include "backends/bundle_adjustment/options.hpp"

namespace evbench::bundle_adjustment {

void Options::declare(OptionSet& set) {
  set.add("batch_duration", batch_duration, "time over which a batch gathers observations [s]").above(0.0);
  set.add("batch_observations", batch_observations, "observations in a batch; 0: batches by duration").range(0);
  set.add("batch_motion", batch_motion,
          "median motion of a batch's tracks in the image, at which it ends [px]; 0: batches by duration")
      .range(0.0);
  set.add("min_batch_duration", min_batch_duration,
          "shortest duration of a batch by motion [s]; batch_duration is then the longest")
      .range(0.0);
  set.add("common_noise_px", common_noise_px,
          "part of an observation's noise that all of a track's observations in a batch share, so that their mean "
          "keeps it [px]")
      .range(0.0);
  set.group("initialiser", initialiser, "initialisation from two batches");
  set.add("min_parallax_deg", min_parallax_deg, "parallax of a new landmark, at least [deg]").range(0.0, 90.0);
  set.add("min_track_batches", min_track_batches, "batches in which a new landmark must be seen").range(2);
  set.add("min_track_time", min_track_time,
          "time that these batches must span: over a short time, an outlier fits any motion [s]")
      .range(0.0);
  set.add("outlier_px", outlier_px, "a track with a larger mean reprojection error is removed [px]").above(0.0);
  set.add("window", window, "newest batches that an update optimises; older ones are held").range(2);
  set.add("loss", loss, "robust loss").choices({"none", "huber", "cauchy"});
  set.add("loss_width", loss_width, "reprojection error where the loss stops being quadratic [sigmas of the keypoint]")
      .above(0.0);
  set.add("learn_noise", learn_noise,
          "estimate a factor on the keypoints' sigmas from the residuals, so that loss_width is in units of the actual "
          "errors");
  set.add("iterations", iterations, "iterations of an update, at most").range(1);
  set.add("global_solve", global_solve, "optimise all batches and landmarks at the end");
  set.add("global_iterations", global_iterations, "iterations of the solve at the end, at most").range(1);
  set.add("min_landmarks", min_landmarks, "landmarks in a batch; with fewer, its pose is predicted").range(4);
}

}  // namespace evbench::bundle_adjustment
