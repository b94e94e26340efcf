#pragma once

#include <vector>

#include "core/geometry/types.hpp"
#include "core/support/index.hpp"

namespace evbench::poisson {

/// What is known of the brightness around a tracked point, learnt from the events that it makes while it moves.
///
/// A pixel has an event for each change of log intensity by the contrast threshold C. While the patch moves by the way
/// l along the unit vector d, n₊ ON and n₋ OFF events come from a place u on it, and n₊ − n₋ = −g(u)·d l / C, g the
/// gradient of log intensity. The least-squares estimate over all motion so far is g/C = M⁻¹ b(u), with M = Σ l d dᵀ,
/// the same for all places, and b(u) = Σ ∓d over the place's events (− for ON). So the rate of ON events, per pixel of
/// way along d, is max(0, −g·d / C), that of OFF events max(0, g·d / C): where events are expected, and of which
/// polarity, whatever the direction of motion. Nothing like it is known for directions that the patch has not moved
/// along; there the count of all events of a place takes its part.
class Patch {
 public:
  /// Shares that enter the rate beside the gradient's.
  struct Shares {
    double any_direction;  ///< of the place's events, whatever the direction and polarity that they had
    double noise;          ///< of the mean rate, anywhere
    bool polarity;         ///< false: the polarity of events is ignored
  };

  explicit Patch(double radius);  ///< [px]

  /// The patch has moved by a way [px] along a unit vector (in its own axes). What it knew fades: by 1/e over `memory`
  /// [px].
  void move(const Vector2& direction, double way, double memory);
  /// An event at a place [px from the centre] during that motion.
  void add(const Vector2& place, bool on, const Vector2& direction);

  /// Prepares the rates for motion along a unit vector.
  void look(const Vector2& direction, const Shares& shares);
  struct Rate {
    double value;  ///< events per px² and px of way, over the mean
    double x, y;   ///< its derivatives by the place [1/px]
  };
  /// Bilinear. Places outside have the rate of noise.
  Rate rate(const Vector2& place, bool on) const;

  /// Means over the events that are expected within the radius of the centre: of the derivatives of the logarithm of
  /// the rate by the place, of its product with the place, and of the derivative by an angle that turns the place. The
  /// events of a likelihood come from within the radius: that there are none outside says nothing about a motion.
  struct Slope {
    double x = 0.0, y = 0.0, turning = 0.0, growing = 0.0;
  };
  Slope mean_slope() const;

  double events_per_pixel() const { return way_ > 0.0 ? count_ / way_ : 0.0; }  ///< of way

 private:
  struct Cell {
    float x = 0.0F, y = 0.0F, count = 0.0F, unused = 0.0F;  // of 16 bytes
  };

  double radius_;
  int reach_, side_;
  double area_;              ///< [px²]
  std::vector<Cell> cells_;  ///< b(u) and the count, by rows
  double weight_ = 1.0;      ///< of what is added now; older sums are not faded one by one
  Matrix2 M_ = Matrix2::Zero();
  double way_ = 0.0, count_ = 0.0;
  std::vector<float> on_, off_;  ///< for the present look, by rows: rates over the mean, without noise_
  float noise_ = 0.0F;
};

inline Patch::Rate Patch::rate(const Vector2& place, bool on) const {
  const double x = place.x() + reach_, y = place.y() + reach_;
  if (!(x >= 0.0 && y >= 0.0 && x < side_ - 1 && y < side_ - 1)) return {noise_, 0.0, 0.0};
  const int left = static_cast<int>(x), top = static_cast<int>(y);
  const auto fx = static_cast<float>(x - left), fy = static_cast<float>(y - top);
  const float* const upper = &(on ? on_ : off_)[index(top * side_ + left)];
  const float* const lower = upper + side_;
  const float a = upper[0], b = upper[1], c = lower[0], d = lower[1];
  const float up = a + fx * (b - a), down = c + fx * (d - c);
  return {up + fy * (down - up) + noise_, (b - a) + fy * ((d - c) - (b - a)), down - up};
}

}  // namespace evbench::poisson
