#include "backends/gp_map/modules/track_noise.hpp"

#include <utility>
#include <vector>

#include "backends/gp_map/modules/track_errors.hpp"
#include "core/support/median.hpp"

namespace evbench::gp_map {

void TrackNoiseOptions::declare(OptionSet& set) {
  set.add("enabled", enabled, "a track that is noisier than most gets larger sigmas; not without learn.noise");
  set.add("change", change, "while running, factor by which a track's noise must change to be updated").range(1.0);
}

void TrackNoise::estimate_tracks(Estimate& estimate, const TimeSpan& span) const {
  if (!options_.enabled) return;
  const bool running = !span.is_everything();
  const double begun = running ? estimate.now() - memory_ : TimeSpan().from;
  std::vector<std::pair<int, double>> own;
  std::vector<double> scales;
  for (const auto& [j, error] : errors_of_landmarks(estimate.graph(), estimate.noise, {}, span.from, begun)) {
    own.emplace_back(j, error.sigma_scale());
    scales.push_back(own.back().second);
  }
  if (own.empty()) return;
  if (running && median(std::move(scales)) > options_.change) return;  // most are noisier: the motion is wrong
  const double change = running ? options_.change : 1.0;
  for (const auto& [j, scale] : own) {
    const double present = estimate.track_noise(j);
    if (scale < change * present && scale > present / change) continue;
    if (present == 1.0 && scale > 1.0) estimate.count(Count::noisier_tracks);
    estimate.set_track_noise(j, scale);
  }
}

}  // namespace evbench::gp_map
