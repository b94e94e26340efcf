#pragma once

#include <array>
#include <cstddef>

namespace evbench::smoother {

/// As many doubles as one vector register of the target holds; arithmetic on it is elementwise (GCC/Clang vectors).
#if defined(__AVX512F__)
inline constexpr int kLanes = 8;
#elif defined(__AVX__)
inline constexpr int kLanes = 4;
#else
inline constexpr int kLanes = 2;
#endif
using Lane [[gnu::vector_size(8 * kLanes)]] = double;
/// The same without the promise of alignment, for loads and stores.
using LaneAt [[gnu::vector_size(8 * kLanes), gnu::aligned(8), gnu::may_alias]] = double;

inline Lane load(const double* from) { return *reinterpret_cast<const LaneAt*>(from); }
inline void store(double* to, Lane value) { *reinterpret_cast<LaneAt*>(to) = value; }
inline Lane broadcast(double value) { return Lane{} + value; }

inline double sum(Lane value) {
  for (int width = kLanes / 2; width > 0; width /= 2) {
    for (int i = 0; i < width; ++i) value[i] += value[i + width];
  }
  return value[0];
}

/// A 3-vector in each lane.
struct Lane3 {
  Lane x{}, y{}, z{};
};
inline Lane3 operator+(const Lane3& a, const Lane3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Lane3 operator-(const Lane3& a, const Lane3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Lane3 operator*(Lane s, const Lane3& a) { return {s * a.x, s * a.y, s * a.z}; }
inline Lane dot(const Lane3& a, const Lane3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Lane3 cross(const Lane3& a, const Lane3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

}  // namespace evbench::smoother
