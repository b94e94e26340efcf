#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/events/event.hpp"
#include "core/simulation/random.hpp"
#include "frontends/haste/tracking/hypotheses.hpp"

namespace evbench::haste::testing {

/// The pose of a pattern: its middle and its angle.
struct PatternPose {
  Vector2 position = Vector2::Zero();  ///< [px]
  double angle = 0.0;                  ///< [rad]
};

/// Events at random points of lines that move. Each event is a random point of a random line at its time, with a normal
/// error, rounded to a pixel. The share `noise` of the events is anywhere on the sensor instead. Events are evenly
/// spaced in time, `rate` a second. Those outside the sensor are left out.
struct EventPattern {
  std::vector<std::pair<Vector2, Vector2>> lines;  ///< ends, in the pattern's frame [px]
  std::function<PatternPose(double)> pose;
  double rate = 100e3, scatter = 0.4, noise = 0.05;
  int width = 240, height = 180;

  std::vector<Event> events(double duration, std::uint64_t seed) const {
    Random random(seed);
    std::vector<Event> result;
    for (int i = 0; i < duration * rate; ++i) {
      const double t = i / rate;
      const auto& [from, to] = lines[random.index(lines.size())];
      const PatternPose at = pose(t);
      const Vector2 point = from + random.uniform() * (to - from);
      const double c = std::cos(at.angle), s = std::sin(at.angle);
      Vector2 pixel = at.position + Vector2(c * point.x() - s * point.y(), s * point.x() + c * point.y()) +
                      scatter * random.normal2();
      if (random.uniform() < noise) pixel = {random.uniform(0.0, width - 1.0), random.uniform(0.0, height - 1.0)};
      const long x = std::lround(pixel.x()), y = std::lround(pixel.y());
      if (x < 0 || y < 0 || x >= width || y >= height) continue;
      result.push_back({static_cast<std::int64_t>(1e6 * t), static_cast<std::uint16_t>(x),
                        static_cast<std::uint16_t>(y), random.uniform() < 0.5});
    }
    return result;
  }
};

/// A corner and two short lines, which determine the position in all directions and the angle.
inline std::vector<std::pair<Vector2, Vector2>> corner_lines() {
  return {{{-1, -1}, {11, -1}}, {{-1, -1}, {-1, 12}}, {{-9, -7}, {-4, -10}}, {{5, 6}, {9, 4}}};
}

}  // namespace evbench::haste::testing
