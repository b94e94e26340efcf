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

  void declare(OptionSet& set);
};

/// Finds circles among event positions that have been moved to one time: clusters of positions on a circle that is
/// wholly in an image of the given size [px].
std::vector<Circle> find_circles(const SegmentationOptions& options, std::span<const Vector2> places, int width,
                                 int height);

}  // namespace evbench::str
