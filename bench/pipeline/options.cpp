#include "bench/pipeline/options.hpp"

namespace evbench {

void PipelineOptions::declare(OptionSet& set) {
  set.add("interval", interval, "data time between two exchanges of front-end and back-end, at most [s]")
      .range(1e-4, 10.0);
  set.add("observations", observations, "observations between two exchanges, at most; 0: no matter how many").range(0);
  set.add("latency", latency,
          "data time that passes before what the back-end knew at an exchange reaches the front-end [s]")
      .range(0.0, 10.0);
  set.add("mode", mode,
          "sequential: in one thread; concurrent: in two, with the same bytes; free: in two, feedback as soon as it "
          "is there, which is not reproducible")
      .choices({"sequential", "concurrent", "free"});
  set.add("queue", queue, "two threads: exchanges that the front-end may be ahead").range(1, 10000);
  set.add("patience", patience,
          "how long a motion model alone may carry the estimate; a back-end is lost then, and starts anew where "
          "there are tracks [s]")
      .above(0.0);
  set.add("relocalise", relocalise,
          "one that starts anew goes on in the world of before once enough landmarks are in both maps: front-ends are "
          "then told where the others of before are expected");
  set.add("stationary_after", stationary_after,
          "when no track has been observed for so long and tracks are alive, the camera stands still: the tracks are "
          "told to be where they were [s]; 0: never")
      .range(0.0);
}

}  // namespace evbench
