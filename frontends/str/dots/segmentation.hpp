#pragma once

#include <span>
#include <vector>

#include "core/plugin/options.hpp"
#include "frontends/str/dots/circle.hpp"

namespace evbench::str {

/// What is taken for a dot.
struct SegmentationOptions {
  double gap = 3.0;
  int least_events = 40;
  double smallest = 2.0, largest = 60.0;
  double residual = 1.0;
  double covered = 0.6;

  void declare(OptionSet& set) {
    set.add("gap", gap, "events this far apart are of one cluster [px]").range(1.0, 50.0);
    set.add("least_events", least_events, "a cluster with fewer events is no dot").range(8);
    set.add("smallest", smallest, "radius of a dot, at least [px]").range(0.5);
    set.add("largest", largest, "radius of a dot, at most [px]").range(0.5);
    set.add("residual", residual, "its events lie off a circle by at most this, root mean square [px]").above(0.0);
    set.add("covered", covered, "share of the rim's eight sectors on which they lie, at least").range(0.0, 1.0);
  }
};

/// The circles among places of events that have been moved to one time: clusters of places (in an image of the given
/// size [px]) whose events lie on a circle that is wholly in the image.
std::vector<Circle> find_circles(const SegmentationOptions& options, std::span<const Vector2> places, int width,
                                 int height);

}  // namespace evbench::str
