#pragma once

#include <deque>

#include "core/data/track.hpp"
#include "core/plugin/options.hpp"
#include "frontends/str/dots/circle.hpp"

namespace evbench::str {

/// How a dot is tracked.
struct DotOptions {
  int window = 200;
  double longest_window = 0.1;
  int every = 40;
  double gate = 2.5;
  double event_noise = 0.5;
  double acceleration = 5000.0;
  double radius_change = 0.02;

  void declare(OptionSet& set);
};

/// A round spot that is tracked by the events of its rim. Its centre comes from a circle through the newest events,
/// each moved by the dot's velocity from its own time to the middle of their times, which is the time of the estimate.
/// Velocity and radius are estimated as well.
class Dot {
 public:
  Dot(const DotOptions& options, const Circle& circle, const Vector2& velocity, double t);

  /// Its centre at t [s]. Without an event the prediction moves by at most a pixel, as a moving dot makes events.
  Vector2 centre(double t) const;
  /// Distance of a pixel from its rim at t [px].
  double rim_distance(const Vector2& pixel, double t) const;
  double radius() const { return circle_.radius; }
  const Vector2& velocity() const { return velocity_; }  ///< [px/s]
  double newest() const { return newest_; }              ///< [s] of its newest event, or of its beginning

  /// Adds one of its events, in time order. Returns whether an observation is due.
  bool add(const Vector2& pixel, double t);

  /// A position of its centre at the time of one of its events.
  struct Sighting {
    double t;  ///< [s]
    Vector2 centre;
    double residual;  ///< [px] of its events from the rim, root mean square
  };
  /// Estimates the centre from the current events; none where they are too few.
  std::optional<Sighting> locate();

 private:
  struct Seen {
    Vector2 pixel;
    double t;
  };
  DotOptions options_;
  Circle circle_;     ///< at t_
  Vector2 velocity_;  ///< [px/s]
  double t_, newest_;
  std::deque<Seen> window_;
  int since_ = 0;  ///< events since the last observation
};

}  // namespace evbench::str
