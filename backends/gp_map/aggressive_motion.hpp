#pragma once

#include <functional>

#include "backends/gp_map/engine/engine.hpp"
#include "backends/gp_map/noise_learning.hpp"

namespace evbench::gp_map {

/// How many times weaker the prior should be, in factors of ten up to `most`, if most tracks have an error of `error`
/// [sigmas]. `error_at(f)` is their error with a prior f times weaker. The prior is relaxed only as far as it is
/// worthwhile: tracks of a motion that the prior suppresses gain much, a few tracks with a common error by chance gain
/// a little each time.
double worthwhile_relaxation(double error, double most, const std::function<double(double)>& error_at);

/// Keeps track of a camera that moves more aggressively than the prior expects. It moves the newest state to where its
/// observations require it: by more Gauss-Newton steps if one has not converged, and by prior relaxation if the prior
/// suppresses the motion. Otherwise the robust loss would treat good tracks as outliers.
class AggressiveMotion {
 public:
  /// `min_landmarks`: with fewer in view nothing is done; `window`: time in which a relaxed prior recovers [s]; `qc`:
  /// density of the unrelaxed prior.
  AggressiveMotion(int min_landmarks, double window, const Vector6& qc)
      : min_landmarks_(min_landmarks), window_(window), qc_(qc) {}

  // Both are called after an update of the engine, which may have left most tracks with large errors, and make the
  // further updates that are needed. `update`: the summary of the last one; `noise`: of the tracks.

  /// Takes more steps after a damped one, which has not converged, while most tracks have large errors. The next state,
  /// extrapolated from this one, would be farther off still, where the robust loss gives little gradient.
  void converge(Engine& engine, const NoiseLearner& noise, UpdateSummary& update) const;
  /// Relaxes the prior over the newest intervals as far as it is worthwhile while most tracks have large errors.
  void relax_prior(Engine& engine, const NoiseLearner& noise, UpdateSummary& update) const;

  /// Is the prior relaxed now? The errors of the tracks are then those of the motion.
  bool is_prior_relaxed(const FactorGraph& graph) const;

  /// Moves the density of future intervals back towards the unrelaxed one, according to the time that has passed.
  void recover(Engine& engine) const;

 private:
  double newest_error(const FactorGraph& graph, const NoiseLearner& noise) const;

  int min_landmarks_;
  double window_;
  Vector6 qc_;
};

}  // namespace evbench::gp_map
