#pragma once

#include <optional>
#include <vector>

#include "backends/gp_map/factor_graph.hpp"
#include "backends/gp_map/time_span.hpp"

namespace evbench::gp_map {

/// What the residuals of one landmark's track tell, as means over short times, in which white noise vanishes and what
/// a tracker's template does remains: how the track's noise compares with that of the others, whether the track has
/// anything to do with its landmark, and from when on it has slid off it.
class TrackErrors {
 public:
  /// At the graph's estimate, of what was observed in this span. `usual`: NoiseLearner::scale_of_means() of all tracks.
  TrackErrors(const FactorGraph& graph, int landmark, double usual, const TimeSpan& span);

  /// Of its means, the squares [sigmas of all tracks' means].
  std::vector<double> squares() const;

  /// Its sigmas over the stated ones, as that of all tracks is learnt apart: at least 1, for a track that is noisier
  /// than most. A robust estimate, which a short track takes from the others.
  double sigma_scale() const;

  /// Are most of its means farther off than `threshold` sigmas of such means?
  bool is_outlier(double threshold) const;

  /// The time from which all that follows is farther off than that [s]; none where the end is as good as the rest, nor
  /// where none was good before.
  std::optional<double> drifts_from(double threshold) const;

 private:
  struct Block {
    double since = 0.0;             ///< [s]
    int count = 0;                  ///< observations
    Vector2 sum = Vector2::Zero();  ///< of residuals [sigmas as given]
    double square = 0.0;            ///< of the mean [sigmas of such means]
  };
  std::vector<Block> blocks_;
};

}  // namespace evbench::gp_map
