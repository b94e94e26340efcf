#pragma once

#include "backends/gp_map/estimate.hpp"
#include "core/plugin/options.hpp"

namespace evbench::gp_map {

struct RelaxationOptions {
  bool enabled = true;
  double error = 3.0;
  double factor = 10.0;
  double gain = 0.75;
  double most = 100.0;
  int intervals = 3;

  void declare(OptionSet& set);
};

/// Relaxes the motion prior over the newest intervals where the camera moves more aggressively than it expects, which
/// shows in the errors of most tracks. Otherwise the robust loss would treat good tracks as outliers.
class PriorRelaxation {
 public:
  /// `window`: time constant with which a relaxed prior recovers [s]; `qc`: density of the unrelaxed prior.
  PriorRelaxation(const RelaxationOptions& options, double window, const Vector6& qc)
      : options_(options), window_(window), qc_(qc) {}

  /// After an update, which may have left most tracks with large errors. Makes at most two further updates. A weaker
  /// prior stays if it was worth it: tracks of a motion that the prior suppresses gain much, a few tracks with a common
  /// error by chance gain a little.
  void relax(Estimate& estimate) const;

  /// Is the prior relaxed now? The errors of the tracks are then those of the motion.
  bool is_relaxed(const Estimate& estimate) const;

  /// Moves the density of future intervals back towards the unrelaxed one, according to the time that has passed.
  void recover(Estimate& estimate) const;

 private:
  RelaxationOptions options_;
  double window_;
  Vector6 qc_;
};

}  // namespace evbench::gp_map
