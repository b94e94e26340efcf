#pragma once

#include <array>
#include <cstdint>

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

 private:
  std::array<std::uint64_t, 4> state_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace evbench
