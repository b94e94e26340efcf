#pragma once

#include <string>

#include "backends/bundle_adjustment/reconstruction.hpp"

namespace evbench::bundle_adjustment {

/// The views that a solve optimises. Gauge: views before `first_variable`, and `origin`, are held; the view `scale`
/// keeps its distance from the origin.
struct SolveScope {
  int first_used = 0;      ///< sightings in older views are not used
  int first_variable = 0;  ///< older views are held
  int last = 0;            ///< newest view, included
  int origin = 0;
  int scale = 1;
};

struct SolverOptions {
  std::string loss = "huber";
  double loss_width = 1.0;  ///< [sigmas]
  int iterations = 10;
};

struct SolveReport {
  bool usable = false;  ///< false: the solver failed and nothing has changed
  double cost = 0.0;    ///< ½ Σ ρ
  int poses = 0, landmarks = 0, observations = 0, iterations = 0;
};

/// Bundle adjustment of the landmarks seen in variable views, and of these views, over the estimated views in scope
/// (Ceres: Levenberg-Marquardt on the Schur complement, one thread, so that it is deterministic).
SolveReport solve(Reconstruction& map, const PinholeCamera& camera, const SolveScope& scope,
                  const SolverOptions& options);

}  // namespace evbench::bundle_adjustment
