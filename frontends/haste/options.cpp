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
          "the others have moved by this much (mean) since it last changed its state [px]: no track of a stationary "
          "camera starves; 0: never")
      .range(0.0, 10000.0);
  set.add("crowding", crowding, "an older one is this near [px]; 0: never").range(0.0, 1000.0);
  set.add("recognition", recognition,
          "after the whole sensor had no events for 0.1 s, its events match its template less than this [cosine]: the "
          "camera has moved meanwhile; 0: never")
      .range(0.0, 1.0);
  set.add("erratic", erratic, "it moves to and fro within 5 ms, or far otherwise than the others: it follows noise");
}

void GuidanceOptions::declare(OptionSet& set) {
  set.add("outliers", outliers, "tracks end that the back-end rejects as outliers");
  set.add("veto", veto, "tracks end that are far from where the back-end expects their landmarks");
  set.add("reacquire", reacquire,
          "landmarks that come back into view are searched for at their expected positions; their tracks go on");
  set.add("gate", gate, "far is more than this [standard deviations of what is expected]").above(0.0);
  set.add("veto_distance", veto_distance, "and more than this [px]").range(0.0, 1000.0);
  set.add("search", search, "a landmark is searched for within this of its expected position along each axis [px]")
      .range(1, 50);
  set.add("similarity", similarity, "it is found where the events match its template at least this well [cosine]")
      .range(0.0, 1.0);
  set.add("displacement", displacement,
          "landmarks that are displaced together, because the back-end's camera pose is off, are searched for "
          "within this of their expected positions along each axis, at intervals [px]; 0: never")
      .range(0, 100);
  set.add("recognition", recognition,
          "after tracking is lost, until the camera is relocalised in the earlier world, a new tracker goes on with "
          "the track of a landmark whose template the events match at least this well, wherever it is [cosine]; not "
          "without reacquire")
      .range(0.0, 1.0);
  set.add("probation", probation,
          "changes of state through which a re-acquired landmark must be where it is expected before its track goes "
          "on; else it becomes another track")
      .range(1, 1000);
  set.add("tolerance", tolerance, "how far off its expected position it may be meanwhile [px]").above(0.0);
  set.add("memory", memory, "landmarks that were lost less than this ago are searched for [s]").range(0.0, 1e6);
  set.add("degraded", degraded,
          "landmarks are also searched for while the back-end is degraded and a motion model carries the estimate");
}

void Options::declare(OptionSet& set) {
  set.add("tracks", tracks, "trackers alive, at most").range(1, 100'000);
  set.add("seeds", seeds,
          "path of a file of tracks, whose first observations start all tracks, but for those at the border; empty: "
          "detected features")
      .path();
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
  set.add(
      "score_covariance", score_covariance,
      "each observation has a covariance, from how its hypotheses' scores fall along each direction from where they "
      "are highest, against how they usually do: half to three times sigma; false: all are the same");
  set.add("place", place, {"new_state", "midpoint", "refined"},
          "where a tracker that changes its state is observed: at the new state, which leads by half a step; half-way "
          "between the old and the new one; where a paraboloid through its hypotheses' scores is highest");
  set.add("delay", delay,
          "an observation has the time of the middle event of the tracker's window and is published this much later; "
          "one that comes later still gets a time that is not published yet [s]")
      .range(0.0, 1.0);
  set.group("detection", detection, "new features");
  set.group("life", life, "when trackers end");
  set.group("guidance", guidance, "how the back-end's feedback is used");
}

}  // namespace evbench::haste
