#pragma once

#include <cmath>
#include <cstdint>

namespace evbench {

/// Random numbers by hashing a counter. The n-th draw of a stream is known without the draws before it, so that streams
/// (one per pixel) need no state but their counter and do not depend on the order in which threads serve them. The hash
/// is splitmix64's (Steele et al. 2014) over key + n · golden ratio.
class CounterRandom {
 public:
  CounterRandom(std::uint64_t seed, std::uint64_t stream) : key_(mix(mix(stream) ^ seed)) {}

  /// The n-th draw, 64 random bits.
  std::uint64_t bits(std::uint64_t n) const { return mix(key_ + n * 0x9e3779b97f4a7c15ULL); }

  /// Uniform in [0, 1), with 53 random bits.
  double uniform(std::uint64_t n) const { return static_cast<double>(bits(n) >> 11) * 0x1.0p-53; }

  /// Exponential with mean 1.
  double exponential(std::uint64_t n) const { return -std::log1p(-uniform(n)); }

  /// Standard normal (Box and Muller) from draws 2n and 2n + 1: a stream of its own, not to be shared with the others.
  double normal(std::uint64_t n) const {
    return std::sqrt(2.0 * exponential(2 * n)) * std::cos(2.0 * M_PI * uniform(2 * n + 1));
  }

 private:
  static std::uint64_t mix(std::uint64_t z) {
    z += 0x9e3779b97f4a7c15ULL;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }

  std::uint64_t key_;
};

}  // namespace evbench
