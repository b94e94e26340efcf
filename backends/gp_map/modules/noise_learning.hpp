#pragma once

#include <map>

#include "backends/gp_map/smoother.hpp"
#include "core/smoother/factor_graph.hpp"

namespace evbench::gp_map {

/// Estimates the observations' noise from residuals: a scale of the stated sigmas, and the share of their information
/// that counts, because a tracker's errors drift. The mean of n independent errors over a block of time has a variance
/// of sigma²/n per axis. The mean of correlated errors has a larger one, and they count as correspondingly fewer
/// observations. This is the cheapest model of drift; results/reference/drift_models.md compares it with more expensive
/// ones.
///
/// The part of an interval's residuals that a pose error, linear over the interval, explains is due to the motion and
/// is subtracted first. Otherwise errors of the motion model would count as noise, which would make the prior stronger
/// still.
class NoiseLearner {
 public:
  /// Uses the intervals since the last call that are a few states old. Older data fade over `memory` [s].
  void follow(const FactorGraph& graph, double memory);

  /// Adds the residuals of an interval at the graph's estimate; each interval once, in order.
  void add(const FactorGraph& graph, int k);

  double scale() const;  ///< true sigma over the stated one; 1 before there is any residual
  double share() const;  ///< of the information, at most 1

  /// scale() for means over a short time, multiplied by √n: larger if errors drift.
  double scale_of_means() const;

  /// The loss for residuals whitened by the stated sigmas. `width`: in true sigmas.
  RobustLoss loss(RobustLoss::Kind kind, double width) const;

 private:
  /// A median that can fade: a histogram of logarithms.
  class Median {
   public:
    void add(double value);
    void fade(double factor);
    double value() const;  ///< 0 without any

   private:
    std::map<int, double> weights_;
  };
  /// Residuals [stated sigmas] of one track over a short time.
  struct Block {
    double since = 0.0;  ///< [s]
    int count = 0;
    Vector2 sum = Vector2::Zero();
  };
  void add(int landmark, double t, const Vector2& residual);

  Median norms_;               ///< of residuals
  Median means_;               ///< |sum|²/n of blocks
  std::map<int, Block> open_;  ///< by landmark
  int taken_ = 0;              ///< the last interval of follow()
};

/// The noise of a whole history, estimated from all of it.
NoiseLearner learn_noise(const FactorGraph& graph);

}  // namespace evbench::gp_map
