#include "backends/gp_map/options.hpp"

namespace evbench::gp_map {

void PlacementOptions::declare(OptionSet& set) {
  set.add("rule", rule, {"rate", "observations", "motion", "prediction"},
          "rate: evenly in time; observations: after a number of observations; motion: when the tracks have moved; "
          "prediction: when the landmarks are seen off their prediction with constant velocity");
  set.add("rate", rate, "rule \"rate\": control states per second [Hz]").range(0.5, 1000.0);
  set.add("observations", observations, "rule \"observations\": observations between two control states").range(1);
  set.add("motion", motion,
          "rule \"motion\": median distance of the tracks' newest observations from their last one before the newest "
          "control state [px]")
      .above(0.0);
  set.add("deviation", deviation,
          "rule \"prediction\": median distance of the landmarks from their prediction with the newest control state's "
          "velocity; interpolation between two states errs by about an eighth of it [sigmas of the observations]")
      .above(0.0);
  set.add("min_spacing", min_spacing, "all rules but \"rate\": least time between two [s]").range(1e-3, 10.0);
  set.add("max_spacing", max_spacing,
          "all rules but \"rate\": greatest time between two, unless min_spacing is larger [s]")
      .range(1e-3, 10.0);
}

void MapOptions::declare(OptionSet& set) {
  set.group("triangulation", triangulation, "when a track becomes a landmark");
  set.add("min_observations", min_observations, "observations that a track needs to become a landmark").range(2);
  set.add("patience", patience,
          "a track that shows no parallax for this long becomes a landmark at the scene's median depth: it determines "
          "rotation, and where tracks are short, the scale as well; the guess counts until there is parallax [s]")
      .range(0.0);
  set.add("depth_sigma", depth_sigma, "standard deviation of that guess, as a share of the depth").above(0.0);
  set.add("outlier_threshold", outlier_threshold,
          "tracks whose mean reprojection error over all their observations is larger are rejected; the final estimate "
          "truncates a track from where its error, averaged over 0.15 s, stays larger; while running, from where it "
          "stays twice as large [sigmas of such means, larger where trackers drift; of those over 0.15 s, larger still "
          "where their errors have longer tails than normal ones]")
      .above(0.0);
  set.add(
         "leverage", leverage,
         "landmarks that are more than so many times nearer than the scene's median depth get larger sigmas, that grow "
         "with the square of their nearness; 0: none")
      .range(0.0, 1000.0);
  set.add("search_interval", search_interval,
          "least time between the beginnings of two searches of an alternative estimate [s]")
      .range(0.0, 1000.0);
  set.add("returns", returns,
          "maximum number of landmarks that are out of view at one time and are re-acquired later: further re-acquired "
          "tracks become new landmarks with a prior at the old place")
      .range(0);
}

void LearningOptions::declare(OptionSet& set) {
  set.add("prior", prior, {"never", "smoothed", "always"},
          "when the prior's power spectral density is estimated from the data, beginning with qc: never; smoothed: "
          "where motion is observed from both sides, while running for all but the newest 0.1 s, and for the final "
          "estimate from all data; always: also for the newest motion, which can lose the scale where landmarks live "
          "for less than a second or the motion is aggressive");
  set.add("noise", noise,
          "estimate a scale of the observations' sigmas, one more for each track that is noisier than most, and the "
          "share of their information that counts, because trackers drift");
  set.add("window", window,
          "while running, the prior follows the data of this time; after aggressive motion a relaxed prior recovers "
          "in a few times this [s]")
      .range(0.01, 100.0);
  set.add("memory", memory,
          "where those data determine little, the prior follows the data of this longer time; so does the noise; while "
          "running, a track's own noise is estimated until the track has this age [s]")
      .range(0.1, 1000.0);
  set.add("rounds", rounds, "rounds of estimating prior and noise in the final estimate").range(0, 100);
}

void HealthOptions::declare(OptionSet& set) {
  set.add("min_landmarks", min_landmarks, "with fewer landmarks of live tracks the estimate is degraded").range(3);
  set.add("lost_landmarks", lost_landmarks,
          "with fewer the prior alone carries the estimate; for longer than the pipeline's patience: lost")
      .range(1);
}

void ValidationOptions::declare(OptionSet& set) {
  set.add("enabled", enabled,
          "at the end each half of the landmarks estimates the trajectory alone; not with a lag or without "
          "final_iterations");
  set.add("disagreement", disagreement,
          "root mean square distance of both from the whole trajectory, as a share of the path, above which the run "
          "is degraded")
      .above(0.0);
  set.add("iterations", iterations, "of each half, at most").range(1, 1000);
}

void PartsOptions::declare(OptionSet& set) {
  set.add("outliers", outliers, "tracks with large errors are rejected, drifting ones from where they drift");
  set.add("track_noise", track_noise, "a track that is noisier than most gets larger sigmas; not without learn.noise");
  set.add("convergence", convergence, "the newest state takes more steps while most tracks have large errors");
  set.add("relaxation", relaxation, "the prior is relaxed while it suppresses the motion");
  set.add("search", search, "alternative estimates with a plane's other structure are searched for");
  set.add("rejection", rejection, "an initial map that most tracks do not fit is rejected");
  set.add("pose_jump", pose_jump, "a jump of the pose that most re-acquired landmarks show is corrected");
  set.add("reassociations", reassociations, "re-acquired landmarks that stay far off their place are rejected");
  set.add("reversal", reversal, "the final estimate tests whether near and far are swapped in a young map");
}

void Options::declare(OptionSet& set) {
  set.group("placement", placement, "control states");
  set.add("qc", qc,
          "diagonal of the WNOA prior's power spectral density: rotation x y z [rad^2/s^3], translation x y z "
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
  set.group("map", map, "landmarks");
  set.group("health", health, "degraded and lost");
  set.group("validation", validation, "whether the final estimate is to be trusted");
  set.group("parts", parts, "switches, to measure what each part is worth");
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
