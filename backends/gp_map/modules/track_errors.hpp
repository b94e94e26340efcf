#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "backends/gp_map/modules/noise_learning.hpp"
#include "backends/gp_map/smoother.hpp"
#include "core/smoother/factor_graph.hpp"
#include "core/smoother/time_span.hpp"

namespace evbench::gp_map {

/// Errors of one landmark's track, as means of its residuals over short times, in which white noise averages out and
/// drift of the tracker's template remains. They show how the track's noise compares with the others', whether the
/// track belongs to its landmark, and from when on it has drifted.
class TrackErrors {
 public:
  /// Errors at the graph's estimate of the observations in this span. `usual`: NoiseLearner::scale_of_means() of all
  /// tracks.
  TrackErrors(const FactorGraph& graph, int landmark, double usual, const TimeSpan& span);

  /// Squares of its means [sigmas of all tracks' means].
  std::vector<double> squares() const;

  /// Factor on the sigmas of this track; the noise of all tracks is estimated separately. At least 1: larger for a
  /// track that is noisier than most. A robust estimate; for a short track it is close to the others'.
  double sigma_scale() const;

  /// Are most of its means larger than `threshold` sigmas of such means?
  bool is_outlier(double threshold) const;

  /// The time from which on all means are larger than that [s]; none if the last one is not, or if all are.
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

using LandmarkErrors = std::vector<std::pair<int, TrackErrors>>;  ///< by landmark

/// Errors in `span` of the landmarks that have been seen after `seen` and not before `begun` [s].
LandmarkErrors errors_of_landmarks(const FactorGraph& graph, const NoiseLearner& noise, const TimeSpan& span,
                                   double seen, double begun);

}  // namespace evbench::gp_map
