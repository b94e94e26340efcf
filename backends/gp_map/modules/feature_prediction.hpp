#pragma once

#include <map>
#include <utility>
#include <vector>

#include "backends/gp_map/estimate.hpp"
#include "backends/gp_map/track_table.hpp"

namespace evbench::gp_map {

/// Predicts where the landmarks are in the image, for the front-end. An initial map that is not confirmed is used for
/// it, too, because its tracks continue in any case.
class FeaturePrediction {
 public:
  /// All landmarks in view at time t, predicted as the motion prior expects. One whose track has ended counts as
  /// independent of the newest state. `upcoming`: latest time of the next state [s].
  std::vector<UndistortedFeature> expected(Estimate& estimate, TrackTable& tracks, double t, double upcoming);

 private:
  const std::vector<std::pair<TrackId, int>>& nearly_in_view(const Estimate& estimate, const TrackTable& tracks,
                                                             double t, double upcoming);
  const std::optional<Matrix2>& image_covariance(Estimate& estimate, int landmark, bool ended,
                                                 const ImageJacobian& J_state, const Matrix23& J_landmark);

  // Of this step of the estimate:
  std::pair<std::size_t, std::vector<std::pair<TrackId, int>>> nearly_in_view_;  ///< tracks and their landmarks
  std::pair<std::size_t, std::map<int, std::optional<Matrix2>>> covariances_;    ///< by landmark [px²]
};

}  // namespace evbench::gp_map
