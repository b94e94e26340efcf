#pragma once

#include <array>
#include <cstdint>

#include "frontends/haste/tracking/change.hpp"
#include "frontends/haste/tracking/footprints.hpp"

// All hypotheses at once in vector registers (GCC/Clang vectors): their values are the lanes of three quads, and each
// hypothesis' value is the sum over a quad of cells.

namespace evbench::haste {

using Int4 [[gnu::vector_size(16)]] = int;
using Double4 [[gnu::vector_size(32)]] = double;
using Float4 [[gnu::vector_size(16)]] = float;

/// A number of each hypothesis; the last lane repeats that of the null hypothesis.
template <class Quad>
struct Lanes {
  std::array<Quad, 3> quads{};
};
inline constexpr int kLanes = 12;
constexpr int hypothesis_of_lane(int lane) { return lane < kHypotheses ? lane : 0; }

inline Lanes<Double4> to_double(const Lanes<Int4>& lanes) {
  Lanes<Double4> result;
  for (std::size_t i = 0; i < 3; ++i) result.quads[i] = __builtin_convertvector(lanes.quads[i], Double4);
  return result;
}

/// The sums of four quads.
template <class Quad>
Quad sums(const Quad& a, const Quad& b, const Quad& c, const Quad& d) {
  const Quad ab = __builtin_shufflevector(a, b, 0, 4, 1, 5) + __builtin_shufflevector(a, b, 2, 6, 3, 7);
  const Quad cd = __builtin_shufflevector(c, d, 0, 4, 1, 5) + __builtin_shufflevector(c, d, 2, 6, 3, 7);
  return __builtin_shufflevector(ab, cd, 0, 1, 4, 5) + __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
}

/// The four cells of a footprint in a patch of ints or floats.
template <class Number>
struct Block {
  using Quad [[gnu::vector_size(16)]] = Number;
  using PairAt [[gnu::vector_size(8), gnu::aligned(4), gnu::may_alias]] = Number;

  static Quad load(const Number* cell) {
    const PairAt above = *reinterpret_cast<const PairAt*>(cell);
    const PairAt below = *reinterpret_cast<const PairAt*>(cell + kPatchStride);
    return __builtin_shufflevector(above, below, 0, 1, 2, 3);
  }
  static void store(Number* cell, const Quad& values) {
    *reinterpret_cast<PairAt*>(cell) = __builtin_shufflevector(values, values, 0, 1);
    *reinterpret_cast<PairAt*>(cell + kPatchStride) = __builtin_shufflevector(values, values, 2, 3);
  }
};

/// The footprints of an event, seen from each hypothesis around a state.
class HypothesisFootprints {
 public:
  HypothesisFootprints() : HypothesisFootprints(0) {}
  explicit HypothesisFootprints(int angle)
      : null_(&Footprints::of(angle)), plus_(&Footprints::of(angle + 1)), minus_(&Footprints::of(angle - 1)) {}

  const Footprints& null() const { return *null_; }

  /// Calls visit(cell, weights) for a hypothesis and an event's place (Footprints::place from the state).
  template <class Visit>
  [[gnu::always_inline]] auto visit(std::size_t hypothesis, int place, Visit visit) const {
    const Step& step = kSteps[hypothesis];
    const Footprints& table = step.angle == 0 ? *null_ : step.angle > 0 ? *plus_ : *minus_;
    const int seen = place + Footprints::shift(step);
    using Short4At [[gnu::vector_size(8), gnu::aligned(2), gnu::may_alias]] = std::int16_t;
    const auto weights = *reinterpret_cast<const Short4At*>(table.weights(seen));
    return visit(table.cell(seen), __builtin_convertvector(weights, Int4));
  }

 private:
  const Footprints *null_, *plus_, *minus_;
};

/// The sums over all hypotheses' quads, which quad(h) makes.
template <class MakeQuad>
[[gnu::always_inline]] inline auto sums_of_hypotheses(MakeQuad quad) {
  using Quad = decltype(quad(std::size_t{0}));
  const Quad null = quad(0);
  Lanes<Quad> result;
  result.quads[0] = sums<Quad>(null, quad(1), quad(2), quad(3));
  result.quads[1] = sums<Quad>(quad(4), quad(5), quad(6), quad(7));
  result.quads[2] = sums<Quad>(quad(8), quad(9), quad(10), null);
  return result;
}

/// The hypothesis to which the state changes: the best, or the null hypothesis (0) unless the best is better by more
/// than the threshold (TrackerOptions::change_threshold).
inline std::size_t chosen(const Lanes<Double4>& scores, double threshold) {
  const auto& [a, b, c] = scores.quads;
  Double4 most = a > b ? a : b, least = a < b ? a : b;
  most = most > c ? most : c;
  least = least < c ? least : c;
  const auto greater = [](double p, double q) { return p > q ? p : q; };
  const auto less = [](double p, double q) { return p < q ? p : q; };
  const double best = greater(greater(most[0], most[1]), greater(most[2], most[3]));
  const double worst = less(less(least[0], least[1]), less(least[2], least[3]));
  if (!(best - a[0] > threshold * (best - worst))) return 0;
  std::size_t h = 0;
  while (scores.quads[h / 4][h % 4] != best) ++h;
  return h;
}

inline Scores scaled(const Lanes<Double4>& raw, double unit) {
  Scores scores;
  for (std::size_t h = 0; h < scores.of.size(); ++h) scores.of[h] = unit * raw.quads[h / 4][h % 4];
  return scores;
}

}  // namespace evbench::haste
