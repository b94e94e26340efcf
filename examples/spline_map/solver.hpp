#pragma once

#include <string>

#include "landmarks.hpp"
#include "motion_prior.hpp"

namespace spline_map {

/// Gauge: fixes the seven gauge freedoms of monocular vision by the pose at the spline's start and the distance of the
/// camera's positions at two times. Without a fixed scale the penalty on accelerations would shrink the world to a
/// point.
struct Gauge {
  SE3 first;                    ///< pose at the spline's start
  double from = 0.0, to = 0.0;  ///< [s]
  double distance = 1.0;        ///< between the positions at these two times [units]
};

struct SolverOptions {
  std::string loss = "cauchy";
  double loss_width = 2.0;  ///< width of the loss of whitened reprojection errors [sigmas]
  int iterations = 10;
  double tolerance = 1e-5;  ///< relative decrease of the cost below which a solve has converged
};

/// The part of the spline that a solve changes.
struct SolveScope {
  std::size_t first_knot = 0;  ///< older knots are fixed
  double held_from = 0.0;      ///< [s] older observations are ignored
};

struct SolveReport {
  bool usable = false;  ///< false: the solver failed and nothing has changed
  double cost = 0.0;    ///< ½ Σ ρ
  int knots = 0, landmarks = 0, observations = 0, iterations = 0;
};

/// Least squares over the knots from scope.first_knot on and all landmarks in view from them. Terms: every observation
/// at its own time under a robust loss, a penalty on the acceleration at each knot by its density (`densities`, one per
/// knot), and the gauge if the first knots are variable. Observations from fixed knots constrain their landmarks.
/// Ceres: Levenberg-Marquardt on the Schur complement in one thread, so that it is deterministic.
SolveReport solve(Spline& spline, Landmarks& landmarks, const std::vector<MotionDensity>& densities,
                  const evbench::PinholeCamera& camera, const Gauge& gauge, const SolveScope& scope,
                  const SolverOptions& options);

}  // namespace spline_map
