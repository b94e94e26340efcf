#include "frontends/poisson/options.hpp"

namespace evbench::poisson {

void TrackerOptions::declare(OptionSet& set) {
  set.add("radius", radius, "events within this of the point are its patch's [px]").range(3.0, 60.0);
  set.add("memory", memory, "way over which what a patch knows fades to 1/e [px]").above(0.0);
  set.add("any_direction", shares.any_direction,
          "part of a place's events, whatever the direction of motion and the polarity that they had, in its rate of "
          "events; the gradient's part is 1")
      .range(0.0, 100.0);
  set.add("noise", shares.noise, "rate of events anywhere, as a share of the mean rate").range(1e-3, 100.0);
  set.add("polarity", shares.polarity, "the gradient predicts the polarity of events; false: it is ignored");
  set.add("lag", lag, "events come this far behind the edges that make them [px]").range(0.0, 5.0);
  set.add("rotation", rotation, "the patch may turn");
  set.add("scale", scale, "the patch may grow or shrink");
  set.add("acceleration", acceleration,
          "standard deviation of the change of velocity while the point moves by a pixel, as a share of the velocity")
      .range(1e-4, 10.0);
  set.add("independence", independence,
          "share of the events' information that counts: events of one edge are not independent")
      .range(1e-3, 1.0);
  set.add("step", step, "way after which usually many events correct the state [px]; few do after three times as much")
      .range(0.05, 10.0);
  set.add("interval", interval, "way between two observations [px]").range(0.05, 100.0);
}

void LifeOptions::declare(OptionSet& set) {
  set.add("deviation", deviation,
          "the standard deviation of its observations, along their least known direction (a running mean), is larger "
          "than "
          "this [px]")
      .above(0.0);
  set.add("border", border, "it comes this near to the image's border [px]").range(0.0, 1000.0);
  set.add("starvation", starvation,
          "the others have moved by this much (median) since its events last corrected it [px]; 0: never")
      .range(0.0, 10000.0);
  set.add("crowding", crowding, "an older one is this near [px]; 0: never").range(0.0, 1000.0);
}

void Options::declare(OptionSet& set) {
  set.add("tracks", tracks, "trackers alive, at most").range(1, 100'000);
  set.add("seeds", seeds,
          "path of a file of tracks, whose first observations start all tracks, but for those at the border or with "
          "hardly any event around them; empty: detected features")
      .path();
  set.add("threads", threads,
          "threads that trackers are spread over; 0: one a processor; they do not change what is tracked")
      .range(0, 1024);
  set.add("window", window, "newest events around a feature that its first patch is made of").range(20, 10'000);
  set.add("recent", recent, "newest events of the sensor that these are searched in").range(100, 10'000'000);
  set.add("settling", settling, "first observations of a track that are left out: its patch is not known well yet")
      .range(0, 1000);
  set.add("sigma", sigma,
          "standard deviation of an observation beside that which its events leave: of how well patches keep their "
          "points [px]")
      .above(0.0);
  set.add("covariance", covariance,
          "an observation states what its events leave as a covariance: little across an edge, much along it; off: the "
          "same in all directions, that of the least known one");
  set.add(
      "neighbours", neighbours,
      "along an edge, of which its own events say little, a tracker moves as those around it; across it, by its own "
      "events");
  set.add("delay", delay, "observations come this much later than the data [s]").range(0.011, 1.0);
  set.add("outliers", outliers, "tracks end that the back-end rejects as outliers");
  set.group("tracker", tracker, "how a tracker follows its point");
  set.group("detection", detection, "new features");
  set.group("life", life, "a tracker ends when one of these is true");
}

}  // namespace evbench::poisson
