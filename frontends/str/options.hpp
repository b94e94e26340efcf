#pragma once

#include "core/features/detection.hpp"
#include "core/plugin/options.hpp"
#include "frontends/str/batches.hpp"
#include "frontends/str/registration/registration.hpp"

namespace evbench::str {

/// How a track goes from batch to batch.
struct PatchOptions {
  double radius = 12.0;
  int queries = 100;
  double least_fit = 0.5;
  double anchor_fit = 0.6;
  double border = 4.0;
  double crowding = 5.0;

  void declare(OptionSet& set) {
    set.add("radius", radius, "events this near to a track are aligned for it [px]").range(2.0, 1000.0);
    set.add("queries", queries, "so many of them, at most").range(10, 1'000'000);
    set.add("least_fit", least_fit,
            "how well they must lie on the last slice for the track to go on: mean weight of the queries, from 0 for "
            "what chance gives to 1")
        .range(0.0, 1.0);
    set.add("anchor_fit", anchor_fit,
            "a track is where the events fit that were around it when it was anchored, if they fit so well; else it is "
            "anchored anew; 1: a chain from batch to batch alone")
        .range(0.0, 1.0);
    set.add("border", border, "a track ends where it comes this near to the image's border [px]").range(0.0, 1000.0);
    set.add("crowding", crowding, "and where an older one is this near [px]; 0: never").range(0.0, 1000.0);
  }
};

struct Options {
  BatchOptions batch;
  RegistrationOptions registration;
  PatchOptions patch;
  DetectionOptions detection;
  int tracks = 60;
  double sigma = 0.5;
  double interval = 0.01;
  enum class Start { last, backend } start = Start::last;

  Options() {
    batch.duration = 0.1;
    batch.motion = 5.0;
    registration.model = MotionModel::planar_4;
    detection.border = 8.0;
  }

  void declare(OptionSet& set) {
    set.add("tracks", tracks, "tracks alive, as far as there is something to track").range(1, 100'000);
    set.add("sigma", sigma, "standard deviation of an observation [px]").range(1e-6, 1e6);
    set.add("interval", interval,
            "a track is observed at events of it that are about this far apart, within a batch [s]")
        .range(1e-4, 10.0);
    set.add("start", start, {"last", "backend"},
            "what a batch's registration starts from: the last one's motion; what the back-end predicts for its "
            "landmarks, where it predicts: tracks are then each back-end's own");
    set.group("batch", batch, "when a batch ends");
    set.group("registration", registration, "how the motion of a batch is found");
    set.group("patch", patch, "how tracks go on");
    set.group("detection", detection, "where new tracks begin");
  }
};

}  // namespace evbench::str
