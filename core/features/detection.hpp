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

  void declare(OptionSet& set);
};

/// At most `count` locations worth tracking [px], best first, in the image of these events. The image counts the events
/// per pixel, polarity ignored, and is smoothed. Features keep away from `taken` and from one another, and each part of
/// the image has a limited share of them. `width`, `height`: the sensor's [px].
std::vector<Vector2> detect_features(const DetectionOptions& options, std::span<const Event> events, int width,
                                     int height, std::span<const Vector2> taken, std::size_t count);

}  // namespace evbench
