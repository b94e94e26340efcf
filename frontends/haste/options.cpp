#include "frontends/haste/options.hpp"

namespace evbench::haste {

void LifeOptions::declare(OptionSet& set) {
  set.add("spread", spread, "its hypotheses' scores differ by less than this share of the best one: it follows nothing")
      .range(0.0, 1.0);
  set.add("curvature", curvature,
          "along some direction its scores fall by less than this share of the best one at √2 px from where they are "
          "highest: it follows an edge, along which nothing holds it; -1: never")
      .range(-1.0, 1.0);
  set.add("border", border, "it comes this near to the image's border [px]").range(0.0, 1000.0);
  set.add("starvation", starvation,
          "the others have moved by this much (mean) since it last changed its state [px]: a standing camera starves "
          "nobody; 0: never")
      .range(0.0, 10000.0);
  set.add("crowding", crowding, "an older one is this near [px]; 0: never").range(0.0, 1000.0);
  set.add("recognition", recognition,
          "what it sees after the whole sensor has told nothing for 0.1 s looks less like its template than this "
          "[cosine]: the camera has moved meanwhile; 0: never")
      .range(0.0, 1.0);
}

void GuidanceOptions::declare(OptionSet& set) {
  set.add("outliers", outliers, "tracks that the back-end holds for outliers end");
  set.add("veto", veto, "tracks end that are far from where the back-end expects their landmarks");
  set.add("reacquire", reacquire,
          "landmarks that come back into view are looked for where they are expected, and their tracks go on");
  set.add("gate", gate, "far is more than this [standard deviations of what is expected]").above(0.0);
  set.add("veto_distance", veto_distance, "and more than this [px]").range(0.0, 1000.0);
  set.add("search", search, "a landmark is looked for within this of its expected place along each axis, at most [px]")
      .range(1, 50);
  set.add("similarity", similarity, "it is found where the events look at least this much like its template [cosine]")
      .range(0.0, 1.0);
  set.add("displacement", displacement,
          "where landmarks are displaced together, as the camera is not where the back-end has it, they are looked "
          "for within this of their expected places along each axis, now and then [px]; 0: never")
      .range(0, 100);
  set.add("recognition", recognition,
          "after a loss, until the camera has been found in the world of before, new trackers go on with the tracks "
          "of landmarks that the events look at least this much like, wherever they are [cosine]; not without "
          "reacquire")
      .range(0.0, 1.0);
  set.add("probation", probation,
          "changes of state through which a found one must be where it is expected before its track goes on; else "
          "it is another track")
      .range(1, 1000);
  set.add("tolerance", tolerance, "and how far off that is meanwhile, at most [px]").above(0.0);
  set.add("memory", memory, "landmarks are looked for that were lost less than this ago [s]").range(0.0, 1e6);
  set.add("corners", corners,
          "a landmark that isn't found by its template, or has none, is taken to be the corner that is detected near "
          "its expected place, on probation, if no other lost one is expected there; not without reacquire");
  set.add("degraded", degraded,
          "landmarks are looked for while the back-end is degraded, too, and a motion model carries the estimate");
}

void Options::declare(OptionSet& set) {
  set.add("tracks", tracks, "trackers alive, as far as there is something to track").range(1, 100'000);
  set.add("threads", threads,
          "threads that trackers are spread over; 0: one a processor; they do not change what is tracked")
      .range(0, 1024);
  set.add("variant", tracker.variant,
          {"correlation", "haste_correlation", "haste_correlation_star", "haste_difference", "haste_difference_star"},
          "how hypotheses are scored, by the published names");
  set.add("change_threshold", tracker.change_threshold,
          "a tracker changes its state when (best - null) / (best - worst) of its hypotheses' scores is above this")
      .range(0.0, 1.0);
  set.add("template_learning", tracker.template_learning, "what an event adds to its tracker's template")
      .range(0.0, 1.0);
  set.add("sigma", sigma, "standard deviation of an observation, usually [px]").range(1e-6, 1e6);
  set.add("score_sigma", score_sigma,
          "that of each follows from how its hypotheses' scores fall from where they are highest, against how they "
          "usually do: half to three times as large; false: all are the same");
  set.add("place", place, {"new_state", "midpoint", "refined"},
          "where a tracker that changes its state is observed: at the new state, which leads by half a step; half-way "
          "between the old and the new one; where a paraboloid through its hypotheses' scores is highest");
  set.add("delay", delay,
          "an observation stands for the middle of the events that a tracker looks at, and is told this much later; "
          "one that comes later still counts as of then [s]")
      .range(0.0, 1.0);
  set.group("detection", detection, "new features");
  set.group("life", life, "when trackers are given up");
  set.group("guidance", guidance, "what is made of the back-end's knowledge");
}

}  // namespace evbench::haste
