#include "frontends/str/motion/options.hpp"

namespace evbench::str {

void MotionTracksOptions::declare(OptionSet& set) {
  set.add("shortest_batch", shortest_batch,
          "a batch that has no one motion, as where it turns round, is divided into halves, down to this [s]")
      .range(1e-3, 10.0);
  set.add("shortest_fit", shortest_fit,
          "and these are believed if they fit so well, chance included (registration.least_fit is for longer ones): "
          "about right is better than nothing, as they move little")
      .range(0.0, 1.0);
  set.add("patience", patience,
          "where not even these have one, it is taken to change evenly from that before to that after; all points end "
          "where none is found for so long [s]")
      .range(0.0, 10.0);
  set.add("spacing", spacing, "between points, where they begin [px]").range(5.0, 10'000.0);
  set.add("sigma", sigma, "standard deviation of an observation, as it is told [px]").range(1e-6, 1e6);
  set.group("batch", batch, "when a batch ends");
  set.group("registration", registration, "how the motion of a batch is found");
}

}  // namespace evbench::str
