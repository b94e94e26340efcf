#include "frontends/str/dots/options.hpp"

namespace evbench::str {

void DotLifeOptions::declare(OptionSet& set) {
  set.add("residual", residual, "its events lie off its rim by more than this, root mean square [px]").above(0.0);
  set.add("radius", radius, "its radius has changed by more than this share since it was found").above(0.0);
  set.add("starvation", starvation, "it has no events while the image moves by this [px]").above(0.0);
  set.add("find_again", find_again,
          "a dot that comes back after its track has ended goes on with that track, if the dots lie on a plane");
  set.add("search", search, "it is the dot that is expected within this of it, if no other one is [px]").above(0.0);
}

void DotsOptions::declare(OptionSet& set) {
  set.add("sigma", sigma, "standard deviation of an observation [px]").range(1e-6, 1e6);
  set.add("delay", delay,
          "an observation has the time of the middle of its events and is published this much later; one that comes "
          "later still gets a time that is not published yet [s]")
      .range(0.0, 1.0);
  set.group("batch", batch, "when a batch ends, after which new dots are looked for");
  set.group("registration", registration, "how the motion of a batch is found");
  set.group("segmentation", segmentation, "what is taken for a new dot");
  set.group("dot", dot, "how a dot is followed");
  set.group("life", life, "when a dot's track ends, and when it goes on");
}

}  // namespace evbench::str
