#include "backends/gp_map/options.hpp"

namespace evbench::gp_map {

void HealthOptions::declare(OptionSet& set) {
  set.add("min_landmarks", min_landmarks, "with fewer landmarks of live tracks the estimate is degraded").range(3);
  set.add("lost_landmarks", lost_landmarks,
          "with fewer the prior alone carries the estimate; for longer than the pipeline's patience: lost")
      .range(1);
}

void Options::declare(OptionSet& set) {
  set.group("placement", placement, "control states");
  set.add("prior", prior, {"wnoa", "singer"},
          "motion prior: wnoa, white noise on acceleration; singer: the same noise smoothed over 1/prior_rate, with "
          "accelerations as unknowns: better where states are sparse for the motion, at 1.5 times the time");
  set.add("prior_rate", prior_rate, "how fast accelerations fade with the prior singer [1/s]").range(0.1, 1e4);
  set.add("qc", qc,
          "diagonal of the prior's power spectral density: rotation x y z [rad^2/s^3], translation x y z "
          "[units^2/s^3]; a unit is the median distance of the initial map's landmarks from its first view")
      .size(6)
      .above(0.0);
  set.add("qc_scale", qc_scale, "multiplies qc: above 1 is a weaker prior").range(1e-12, 1e12);
  set.add("loss", loss, {"none", "huber", "cauchy"}, "robust loss of reprojection errors");
  set.add("loss_width", loss_width,
          "residual where the loss stops being quadratic [sigmas; with learn.noise estimated ones]")
      .above(0.0);
  set.add("sigma_scale", sigma_scale, "multiplies the observations' sigmas").range(1e-6, 1e6);
  set.group("learn", learn, "prior and noise");
  set.group("initialiser", initialiser, "two-view initialisation");
  set.add("max_initial_error", max_initial_error, "largest median reprojection error of an initial map [px]")
      .above(0.0);
  set.add("max_initial_uncertainty", max_initial_uncertainty,
          "largest standard deviation of an initial map's distances due to noise, as a share: the parallax that is "
          "needed follows from the noise")
      .above(0.0);
  set.group("map", map, "when tracks become landmarks");
  set.group("leverage", leverage, "bound of the influence of near landmarks");
  set.group("outliers", outliers, "rejection of tracks that follow something else");
  set.group("track_noise", track_noise, "noise of single tracks");
  set.group("relaxation", relaxation, "a weaker prior in aggressive motion");
  set.group("search", search, "search of alternative estimates");
  set.group("reassociation", reassociation, "re-acquired tracks");
  set.group("validation", validation, "whether the final estimate is to be trusted");
  set.group("health", health, "degraded and lost");
  set.add("lag", lag,
          "control states older than this are marginalised, for endless streams in bounded memory [s]; 0: full "
          "history, with a final estimate over everything")
      .range(0.0);
  set.add("per_observation", per_observation,
          "the newest pose and velocity follow each observation instead of each control state; the causal trajectory "
          "has a pose for each");
  set.add("final_iterations", final_iterations, "iterations over the whole history, at the end; 0: none").range(0);
}

}  // namespace evbench::gp_map
