#include "frontends/str/options.hpp"

namespace evbench::str {

void PatchOptions::declare(OptionSet& set) {
  set.add("radius", radius, "events this near to a track are aligned for it [px]").range(2.0, 1000.0);
  set.add("queries", queries, "so many of them, at most").range(10, 1'000'000);
  set.add("least_fit", least_fit,
          "how well they must lie on the last slice for the track to go on: mean weight of the queries, from 0 for "
          "what chance gives to 1")
      .range(0.0, 1.0);
  set.add("anchor_fit", anchor_fit,
          "a track is placed by the events that were around it when it was anchored, if they fit so well; else it gets "
          "a new anchor; 1: a chain from batch to batch alone")
      .range(0.0, 1.0);
  set.add("border", border, "a track ends where it comes this near to the image's border [px]").range(0.0, 1000.0);
  set.add("crowding", crowding, "and where an older one is this near [px]; 0: never").range(0.0, 1000.0);
}

void Options::declare(OptionSet& set) {
  set.add("tracks", tracks, "tracks alive, at most").range(1, 100'000);
  set.add("seeds", seeds,
          "path of a file of tracks, whose first observations start all tracks, but for those at the border; empty: "
          "detected features")
      .path();
  set.add("sigma", sigma, "standard deviation of an observation [px]").range(1e-6, 1e6);
  set.add("interval", interval, "a track is observed at events of it that are about this far apart, within a batch [s]")
      .range(1e-4, 10.0);
  set.add("start", start, {"last", "backend"},
          "what a batch's registration starts from: the last one's motion; what the back-end predicts for its "
          "landmarks, where it predicts: tracks are then each back-end's own");
  set.group("batch", batch, "when a batch ends");
  set.group("registration", registration, "how the motion of a batch is found");
  set.group("patch", patch, "how tracks go on");
  set.group("detection", detection, "where new tracks begin");
}

}  // namespace evbench::str
