#pragma once

#include <array>
#include <cstdint>

#include "core/geometry/types.hpp"

namespace evbench {

/// Random numbers that are the same with every compiler and standard library: xoshiro256++ (Blackman and Vigna 2019),
/// its state filled by splitmix64. Different streams of one seed are independent.
class Random {
 public:
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0);

  std::uint64_t next();

  /// Uniform in [0, 1), with 53 random bits.
  double uniform();
  double uniform(double from, double to) { return from + (to - from) * uniform(); }

  /// Uniform in {0, ..., count − 1}; count > 0.
  std::size_t index(std::size_t count);

  /// Standard normal, by Marsaglia's polar method.
  double normal();

  /// The last coordinate of a vector is drawn first. The order is fixed, unlike that of a function's arguments.
  Vector2 uniform2(const Vector2& from, const Vector2& to);
  Vector3 uniform3(const Vector3& from, const Vector3& to);
  Vector2 normal2();
  Vector3 normal3();

 private:
  std::array<std::uint64_t, 4> state_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace evbench
