#include "eval/fit_offset.hpp"

#include <cmath>
#include <limits>

#include "core/support/error.hpp"

namespace evbench {

double fit_time_offset(const PoseTrajectory& ground_truth, const PoseTrajectory& estimate, ScoreOptions options,
                       double reach) {
  constexpr int kSteps = 20;  // to each side
  constexpr double kPrecision = 1e-4;
  options.association = "interpolated";
  double best = options.time_offset, least = std::numeric_limits<double>::infinity();
  std::string reason;
  const auto try_offset = [&](double offset) {
    options.time_offset = offset;
    try {
      const double error = score(ground_truth, estimate, options).ate.trans_m.rmse;
      if (error < least) {
        least = error;
        best = offset;
      }
    } catch (const InputError& error) {
      reason = error.what();
    }
  };
  // The error has other minima far away: a grid, then finer ones around its best.
  try_offset(best);
  for (double step = reach / kSteps; step > 0.1 * kPrecision; step /= kSteps / 2.0) {
    const double centre = best;
    for (int i = -kSteps; i <= kSteps; ++i) try_offset(centre + i * step);
  }
  if (!std::isfinite(least)) throw InputError(reason);
  return best;
}

}  // namespace evbench
