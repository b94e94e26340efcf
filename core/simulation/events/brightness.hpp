#pragma once

#include <span>

namespace evbench {

/// The light that falls on the pixels: log intensity over time, interval by interval. An implementation may choose
/// intervals in which it changes little.
class Brightness {
 public:
  /// An interval is divided into this many parts; at their ends single pixels can be queried.
  static constexpr int kParts = 32;

  virtual ~Brightness() = default;

  virtual int width() const = 0;
  virtual int height() const = 0;

  /// Starts, or restarts, at time t [s].
  virtual void start(double t) = 0;

  /// Advances to the next interval, which begins where the last one ended; returns its end [s], at most `limit`.
  virtual double advance(double limit) = 0;

  /// The farthest that anything moved over the image in the interval [px]; 0: not known.
  virtual double displacement() const { return 0.0; }

  /// Log intensity of all pixels at the interval's end, by rows.
  virtual std::span<const float> image() const = 0;

  /// Log intensity of a pixel at the end of a part of the interval, 0 < part < parts. May be called by several threads.
  virtual float within(int x, int y, int part) const = 0;
};

}  // namespace evbench
