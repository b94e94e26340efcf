#include "frontends/str/registration/alignment.hpp"
#include "frontends/str/registration/registration.hpp"

namespace evbench::str {

void AlignmentOptions::declare(OptionSet& set) {
  set.add("distance", distance, {"point", "line"},
          "what is minimised: the distance between matched events, or its part across the edge on which they lie");
  set.add("polarity", polarity, "only events of the same polarity are matched");
  set.add("keep", keep, "share of the matches that count, the nearest ones").range(0.05, 1.0);
  set.add("gate", gate, "events are matched over at most this distance at first [px]").above(0.0).range(0.0, 100.0);
  set.add("last_gate", last_gate, "and over this distance in the end [px]").above(0.0).range(0.0, 100.0);
  set.add("gate_shrinking", gate_shrinking, "by this factor from one iteration to the next").range(0.1, 0.99);
  set.add("robust_scale", robust_scale, "distance at which a match counts half (Cauchy) [px]").above(0.0);
  set.add("edge_noise", edge_noise, "distance of events from an edge, standard deviation [px]").above(0.0);
  set.add("cell", cell, "side of the cells in which events are searched [px]").range(0.5, 100.0);
  set.add("stale", stale, "cells are rebuilt when the motion has moved an event by more than this since [px]")
      .range(0.0, 10.0);
  set.add("first_queries", first_queries,
          "events that the first iterations are made with, until these move by less than the tolerance; then all "
          "others join them; 0: all from the beginning")
      .range(0);
  set.add("iterations", iterations, "at most").range(1, 1000);
  set.add("tolerance", tolerance, "a change of the motion over a batch that is none [px, mean]").above(0.0);
}

void RegistrationOptions::declare(OptionSet& set) {
  set.add("model", model, {"rotation", "translation", "planar_4", "planar_8"},
          "how the image moves: as the camera rotates; image translation; and rotation about the axis and zoom; any "
          "homography");
  set.add("slice", slice, "the first and the last part of a batch that are aligned, as a share of it").range(0.01, 0.5);
  set.add("queries", queries, "events of the first slice that are matched with the last one, at most; 0: all").range(0);
  set.add("least_events", least_events, "with fewer events in a slice no motion is estimated").range(10);
  set.add("least_fit", least_fit,
          "how well the slices must match for a motion to be accepted: mean weight of the queries, 0 for those without "
          "a match, from 0 for chance to 1")
      .range(0.0, 1.0);
  set.add("halvings", halvings,
          "where the start fails, the last part of the batch is tried, halved so many times, then parts that double in "
          "length")
      .range(0, 20);
  set.add("trusted_motion", trusted_motion, "a part that moved by less than this starts no other [px, mean]")
      .range(0.0);
  set.group("alignment", alignment, "how two slices are aligned");
}

}  // namespace evbench::str
