#pragma once

#include <map>

#include "backends/gp_map/factor_graph.hpp"

namespace evbench::gp_map {

/// Learns the observations' noise from residuals: a scale of the stated sigmas, and the share of the information that
/// counts, as a tracker's errors drift. The mean of n independent errors over a block of time has a variance of
/// sigma²/n an axis; that of errors which hang together is larger, and they count as so many observations less. That
/// is the cheapest model of drift; results/reference/drift_models.md compares it with dearer ones.
///
/// What a pose error, linear over an interval, explains of its residuals tells of the motion, not of noise, and is
/// taken away first: a motion model that is wrong must not pass for noise, which would then make the prior stronger
/// still.
class NoiseLearner {
 public:
  /// Takes the intervals since the last call that are a few states old; what was taken before fades over `memory` [s].
  void follow(const FactorGraph& graph, double memory);

  /// The residuals of an interval at the graph's estimate; each interval once, in order.
  void add(const FactorGraph& graph, int k);

  double scale() const;  ///< true sigma over the stated one; 1 before there is any residual
  double share() const;  ///< of the information, at most 1

  /// The same as scale() for what is averaged over a short time and taken times √n: of errors that drift, larger.
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

/// The noise of a whole history, from all of it.
NoiseLearner learn_noise(const FactorGraph& graph);

}  // namespace evbench::gp_map
