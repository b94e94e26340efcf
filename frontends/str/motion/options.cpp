#include "frontends/str/motion/options.hpp"

namespace evbench::str {

void MotionTracksOptions::declare(OptionSet& set) {
  set.add("shortest_batch", shortest_batch,
          "a batch without a single motion, as where it reverses, is divided into halves, down to this [s]")
      .range(1e-3, 10.0);
  set.add("shortest_fit", shortest_fit,
          "these are accepted if they fit so well, chance included (registration.least_fit is for longer ones): a "
          "rough motion is better than none, as they move little")
      .range(0.0, 1.0);
  set.add("patience", patience,
          "where these have none either, the motion is interpolated linearly; all points end where none is found for "
          "so long [s]")
      .range(0.0, 10.0);
  set.add("spacing", spacing, "between points, where they begin [px]").range(5.0, 10'000.0);
  set.add("sigma", sigma, "standard deviation of an observation, as it is published [px]").range(1e-6, 1e6);
  set.group("batch", batch, "when a batch ends");
  set.group("registration", registration, "how the motion of a batch is found");
}

}  // namespace evbench::str
