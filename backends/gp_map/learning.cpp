#include "backends/gp_map/learning.hpp"

#include <vector>

namespace evbench::gp_map {

OptimiseSummary estimate_everything(Map& map, TrackTable& tracks, const Options& options) {
  constexpr int kIterationsARound = 3;
  constexpr double kRoughly = 1e-4, kEstimated = 1e-6, kFixed = 1e-9;  // estimated parameters are not more accurate
  Estimate& estimate = map.estimate;
  const bool learns = options.learn.prior != LearnPrior::never || options.learn.noise;
  const int rounds = learns ? options.learn.rounds : 1;
  estimate.smoother.optimise(kIterationsARound, kRoughly);
  for (int round = 0; round < rounds; ++round) {
    if (options.learn.noise) {
      estimate.noise = learn_noise(estimate.graph());
      estimate.smoother.set_loss(estimate.noise.loss(options.loss, options.loss_width));
    }
    map.prior.smooth(estimate, {});
    map.outliers.reject_smoothed(estimate, tracks, {});
    if (options.learn.noise) map.track_noise.estimate_tracks(estimate, {});
    const bool settled = estimate.smoother.optimise(kIterationsARound, kRoughly).iterations == 1;
    if (settled && round > 0) break;  // the estimated parameters no longer change the estimate
  }
  return estimate.smoother.optimise(options.final_iterations, learns ? kEstimated : kFixed);
}

void estimate_remaining(Map& map, TrackTable& tracks, const Options& options) {
  // Marginalised intervals keep their expansions: balancing only the others again would change their scale.
  const std::vector<double> surplus = surplus_expansions(map.estimate.smoother);
  for (int round = 0; round < options.learn.rounds; ++round) {
    learn_smoothed(map, tracks, options, {}, surplus);
    map.estimate.update();
  }
}

void learn_smoothed(Map& map, TrackTable& tracks, const Options& options, const TimeSpan& span,
                    std::span<const double> surplus) {
  Estimate& estimate = map.estimate;
  if (!estimate.is_tentative()) map.outliers.reject_smoothed(estimate, tracks, span);  // else it may be wrong itself
  const bool relaxed = options.learn.prior != LearnPrior::always && map.relaxation.is_relaxed(estimate);
  if (options.learn.noise && !relaxed) map.track_noise.estimate_tracks(estimate, span);
  map.prior.smooth(estimate, span, surplus);
}

}  // namespace evbench::gp_map
