#pragma once

#include <bit>
#include <cstdint>

namespace evbench {

/// Natural logarithm of a positive, normal number, to 2e-7; a compiler makes vectors of it, unlike of std::log.
inline float fast_log(float x) {
  constexpr std::uint32_t kSqrtHalf = 0x3f3504f3;  // the bits of √½
  const std::uint32_t from = std::bit_cast<std::uint32_t>(x) - kSqrtHalf;
  const auto exponent = static_cast<float>(static_cast<std::int32_t>(from) >> 23);
  const float m = std::bit_cast<float>((from & 0x7fffffU) + kSqrtHalf);  // x = m 2^exponent, m from √½ to √2
  // log m = 2 artanh s = 2 (s + s³/3 + s⁵/5 + ...)
  const float s = (m - 1.0F) / (m + 1.0F), q = s * s;
  const float series = 1.0F + q * (1.0F / 3.0F + q * (1.0F / 5.0F + q * (1.0F / 7.0F + q * (1.0F / 9.0F))));
  return exponent * 0.693147181F + 2.0F * s * series;
}

/// exp(x) to 3e-7 for x from −80 to 80, likewise.
inline float fast_exp(float x) {
  const float scaled = x * 1.44269504F;
  const auto whole = static_cast<std::int32_t>(scaled + (scaled < 0.0F ? -0.5F : 0.5F));
  // x = whole log 2 + r, |r| ≤ 0.35; log 2 in two parts.
  const float k = static_cast<float>(whole), r = (x - k * 0.693359375F) + k * 2.12194440e-4F;
  const float series =
      1.0F + r * (1.0F + r * (0.5F + r * (1.0F / 6.0F + r * (1.0F / 24.0F + r * (1.0F / 120.0F + r / 720.0F)))));
  return series * std::bit_cast<float>((whole + 127) << 23);
}

}  // namespace evbench
