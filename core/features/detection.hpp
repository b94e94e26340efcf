#pragma once

#include <span>
#include <vector>

#include "core/events/event.hpp"
#include "core/geometry/types.hpp"
#include "core/plugin/options.hpp"

namespace evbench {

struct DetectionOptions {
  enum class Method { corners, histogram } method = Method::corners;
  int events = 15000;
  double interval = 0.02;
  double distance = 15.0;
  double quality = 0.02;
  double border = 16.0;

  void declare(OptionSet& set) {
    set.add(
        "method", method, {"corners", "histogram"},
        "corners: of the image of the newest events (Shi and Tomasi 1994); histogram: where most of them are (Liu et "
        "al. 2022)");
    set.add("events", events, "newest events that are looked at").range(100, 10'000'000);
    set.add("interval", interval, "time between two detections, where features are missing [s]").above(0.0);
    set.add("distance", distance, "new features keep this far from one another and from those that are tracked [px]")
        .range(1.0, 1000.0);
    set.add("quality", quality,
            "a feature is at least this good, as a share of the best one's corner measure, or count")
        .range(0.0, 1.0);
    set.add("border", border, "and this far from the image's border [px]").range(0.0, 1000.0);
  }
};

/// At most `count` places worth tracking [px], the best ones first, in the image of these events: pixels count their
/// events, polarity ignored, smoothed. They keep away from `taken`, and from one another, and only a share of all is in
/// one part of the image. The sensor's size in pixels.
std::vector<Vector2> detect_features(const DetectionOptions& options, std::span<const Event> events, int width,
                                     int height, std::span<const Vector2> taken, std::size_t count);

}  // namespace evbench
