#include "bench/pipeline/options.hpp"

namespace evbench {

void PipelineOptions::declare(OptionSet& set) {
  set.add("interval", interval, "data time between two exchanges of front-end and back-end, at most [s]")
      .range(1e-4, 10.0);
  set.add("observations", observations, "observations between two exchanges, at most; 0: no limit").range(0);
  set.add("latency", latency,
          "data time from an exchange until the back-end's feedback on it reaches the front-end [s]")
      .range(0.0, 10.0);
  set.add("mode", mode,
          "sequential: one thread; concurrent: two threads, identical results; free: two threads, feedback as soon as "
          "it is available, not reproducible")
      .choices({"sequential", "concurrent", "free"});
  set.add("queue", queue, "with two threads: exchanges by which the front-end may be ahead").range(1, 10000);
  set.add("patience", patience,
          "time that the motion model alone may carry the estimate [s]; after that tracking is lost, and a new "
          "back-end re-initialises")
      .above(0.0);
  set.add("relocalise", relocalise,
          "after a re-initialisation the estimate continues in the earlier world once enough landmarks are in both "
          "maps; feedback then also predicts the other landmarks of the earlier map");
  set.add("stationary_after", stationary_after,
          "time without observations, while tracks are alive, after which the camera counts as stationary [s]: the "
          "back-end then gets the tracks' last positions again; 0: never")
      .range(0.0);
}

}  // namespace evbench
