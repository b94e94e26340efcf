#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/smoother/engine/lanes.hpp"

namespace evbench::smoother {

/// The bits of a Lane's doubles, also the results of comparisons; WrappingBits where a sum may wrap around, as NaN's
/// bits do.
using LaneBits [[gnu::vector_size(8 * kLanes)]] = std::int64_t;
using WrappingBits [[gnu::vector_size(8 * kLanes)]] = std::uint64_t;

/// √x. One instruction where the file is compiled with -fno-math-errno.
inline Lane sqrt(Lane x) {
  Lane result{};
  for (int i = 0; i < kLanes; ++i) result[i] = std::sqrt(x[i]);
  return result;
}

/// ln(1 + x) for x ≥ 0, within 2 ulp. With 1 + x = 2^k (1 + f), |f| ≤ √2 − 1: k ln 2 + ln(1 + f), where
/// ln(1 + f) = 2 artanh(s), s = f/(2 + f), by fdlibm's polynomial; what rounding 1 + x lost is added to first order.
inline Lane log1p(Lane x) {
  constexpr std::int64_t kOne = 0x3ff0000000000000, kRootHalf = 0x3fe6a09e00000000, kMantissa = 0x000fffffffffffff;
  constexpr double kLn2High = 6.93147180369123816490e-01, kLn2Low = 1.90821492927058770002e-10;
  const Lane u = 1.0 + x;
  const auto from_root = std::bit_cast<LaneBits>(std::bit_cast<WrappingBits>(u) + (kOne - kRootHalf));
  const LaneBits exponent = (from_root >> 52) - 1023;
  const Lane k = __builtin_convertvector(exponent, Lane);
  const Lane lost = (exponent > 1 ? 1.0 - (u - x) : x - (u - 1.0)) / u;
  const Lane f = exponent == 0 ? x : std::bit_cast<Lane>((from_root & kMantissa) + kRootHalf) - 1.0;
  const Lane half_square = 0.5 * f * f;
  const Lane s = f / (2.0 + f);
  const Lane z = s * s, w = z * z;
  const Lane odd = w * (3.999999999940941908e-01 + w * (2.222219843214978396e-01 + w * 1.531383769920937332e-01));
  const Lane even =
      z * (6.666666666666735130e-01 +
           w * (2.857142874366239149e-01 + w * (1.818357216161805012e-01 + w * 1.479819860511658591e-01)));
  const Lane correction = exponent == 0 ? Lane{} : k * kLn2Low + lost;
  const Lane result = s * (half_square + odd + even) + correction - half_square + f + k * kLn2High;
  return x < std::numeric_limits<double>::infinity() ? result : x;  // NaN stays
}

}  // namespace evbench::smoother
