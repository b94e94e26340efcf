#include "eval/fit_offset.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/support/error.hpp"

namespace evbench {

OffsetFit fit_time_offset(const PoseTrajectory& ground_truth, const PoseTrajectory& estimate, ScoreOptions options,
                          double reach) {
  constexpr int kSteps = 20;           // to each side
  constexpr double kPrecision = 1e-4;  // [s]
  constexpr double kShare = 0.9;       // of the most pairs: a short overlap always fits well
  struct Trial {
    double offset, error;
    std::size_t pairs;
  };
  options.association = "interpolated";
  const double middle = options.time_offset;
  std::vector<Trial> trials;
  std::string reason;
  const auto try_offset = [&](double offset) {
    options.time_offset = std::clamp(offset, middle - reach, middle + reach);
    try {
      const Scores scores = score(ground_truth, estimate, options);
      trials.push_back({options.time_offset, scores.ate.trans_m.rmse, scores.pairs});
    } catch (const InputError& error) {
      reason = error.what();
    }
  };
  const auto best = [&] {
    std::size_t most = 0;
    for (const Trial& trial : trials) most = std::max(most, trial.pairs);
    Trial result{middle, std::numeric_limits<double>::infinity(), 0};
    for (const Trial& trial : trials) {
      const bool overlaps = static_cast<double>(trial.pairs) >= kShare * static_cast<double>(most);
      if (overlaps && trial.error < result.error) result = trial;
    }
    return result.offset;
  };
  // The error has other minima far away: a grid, then finer ones around its best.
  try_offset(middle);
  double step = reach / kSteps;
  do {
    const double centre = best();
    for (int i = -kSteps; i <= kSteps; ++i) try_offset(centre + i * step);
    step /= kSteps / 2.0;
  } while (step > 0.1 * kPrecision);
  if (trials.empty()) throw InputError(reason);
  return {best(), std::abs(best() - middle) > reach - kPrecision};
}

}  // namespace evbench
