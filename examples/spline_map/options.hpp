#pragma once

#include <evbench/plugin.hpp>

#include "solver.hpp"

namespace spline_map {

struct Options {
  // Trajectory.
  double knot_spacing = 0.1;         ///< [s]
  double rotation_density = 1.0;     ///< [rad²/s³]
  double translation_density = 1.0;  ///< [units²/s³]
  double density_weight = 1.0;       ///< [knots]
  double density_radius = 0.75;      ///< [s]
  // Running.
  double update_period = 0.05;  ///< [s]
  double window = 2.0;          ///< [s]
  double held_window = 3.0;     ///< [s]
  int iterations = 6;
  int final_iterations = 30;
  // Observations.
  std::string loss = "cauchy";
  double loss_width = 2.0;  ///< [sigmas]
  double outlier_px = 2.5;
  // Map.
  evbench::InitialiserOptions initialiser;
  double max_initial_error = 2.0;  ///< [px]
  double ambiguity_ratio = 1.1;
  evbench::TriangulationOptions triangulation;
  int min_observations = 10;
  double min_track_time = 0.3;  ///< [s]
  // Support.
  int min_landmarks = 6;
  int lost_landmarks = 3;

  SolverOptions solver(int most_iterations, double tolerance) const {
    return {loss, loss_width, most_iterations, tolerance};
  }
  /// The densities of a spline that is estimated up to t_end.
  std::vector<MotionDensity> densities(const Spline& spline, double t_end) const {
    return estimate_densities(spline, t_end, density_radius, {rotation_density, translation_density}, density_weight);
  }

  void declare(evbench::OptionSet& set) {
    set.add("knot_spacing", knot_spacing, "time between two knots of the spline [s]").range(0.005, 2.0);
    set.add("rotation_density", rotation_density,
            "expected power spectral density of the angular acceleration (white noise), before any data: "
            "smaller is smoother [rad^2/s^3]")
        .above(0.0);
    set.add("translation_density", translation_density,
            "the same for linear acceleration; a unit is the median depth of the initial map [units^2/s^3]")
        .above(0.0);
    set.add("density_weight", density_weight,
            "weight of the expected densities in those estimated from the motion [knots]")
        .above(0.0);
    set.add("density_radius", density_radius,
            "the densities at a knot are estimated from the knots within this time [s]")
        .above(0.0);
    set.add("update_period", update_period, "time between two estimates while running [s]").range(0.005, 1.0);
    set.add("window", window, "length of the sliding window: knots within are optimised, older ones fixed [s]")
        .above(0.0);
    set.add("held_window", held_window, "time before the window whose observations still constrain landmarks [s]")
        .range(0.0);
    set.add("iterations", iterations, "maximum number of iterations of an update").range(1);
    set.add("final_iterations", final_iterations, "maximum number of iterations over everything at the end; 0: none")
        .range(0);
    set.add("loss", loss, "robust loss of reprojection errors").choices({"none", "huber", "cauchy"});
    set.add("loss_width", loss_width, "width of the robust loss [sigmas]").above(0.0);
    set.add("outlier_px", outlier_px, "tracks with a larger mean reprojection error are removed [px]").above(0.0);
    set.group("initialiser", initialiser, "two-view initialisation");
    set.add("max_initial_error", max_initial_error, "an initial map with a larger median error is rejected [px]")
        .above(0.0);
    set.add("ambiguity_ratio", ambiguity_ratio,
            "wait for more data while the second-best initial map costs less than this times the best one")
        .range(1.0);
    set.group("triangulation", triangulation, "when a track becomes a landmark");
    set.add("min_observations", min_observations, "minimum number of observations of a landmark").range(2);
    set.add("min_track_time", min_track_time,
            "minimum time span of these: over a short time, an outlier fits any motion [s]")
        .range(0.0);
    set.add("min_landmarks", min_landmarks, "with fewer landmarks in view, the estimate is degraded").range(3);
    set.add("lost_landmarks", lost_landmarks,
            "with fewer landmarks in view, the motion prior alone carries the estimate")
        .range(1);
  }
};

}  // namespace spline_map
