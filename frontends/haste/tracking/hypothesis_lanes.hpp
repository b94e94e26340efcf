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

/// A footprint's weights.
inline Int4 quad(const std::array<int, 4>& weights) {
  using Int4At [[gnu::vector_size(16), gnu::aligned(4), gnu::may_alias]] = int;
  return *reinterpret_cast<const Int4At*>(weights.data());
}

/// One number for each hypothesis. A quad holds the three hypotheses that are a step down, none, or up. Quads go from
/// right to left, as events' indices go from left to right. The last lanes hold the two turned hypotheses and the null
/// hypothesis again.
template <class Quad>
struct Lanes {
  std::array<Quad, 3> quads{};

  auto of(std::size_t hypothesis) const { return quads[kLane[hypothesis] / 4][kLane[hypothesis] % 4]; }

  template <class Number>
  void set(std::size_t hypothesis, Number value) {
    quads[kLane[hypothesis] / 4][kLane[hypothesis] % 4] = value;
  }

  static constexpr std::array<std::uint8_t, kHypotheses> kLane{5, 4, 6, 1, 9, 0, 2, 10, 8, 3, 7};
};

inline void add(Lanes<Double4>& sum, const Lanes<Int4>& lanes) {
  for (std::size_t i = 0; i < 3; ++i) sum.quads[i] += __builtin_convertvector(lanes.quads[i], Double4);
}
inline Lanes<Int4> operator-(const Lanes<Int4>& a, const Lanes<Int4>& b) {
  return {{a.quads[0] - b.quads[0], a.quads[1] - b.quads[1], a.quads[2] - b.quads[2]}};
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
  explicit HypothesisFootprints(int angle) {
    for (std::size_t h = 0; h < kHypotheses; ++h) tables_[h] = &Footprints::of(angle + kSteps[h].angle);
  }

  const Footprints& table(std::size_t hypothesis) const { return *tables_[hypothesis]; }

  struct Cells {
    int first;  ///< Footprint::cell
    Int4 weights;
  };
  /// For an event's place (Footprints::place from the state).
  Cells of(std::size_t hypothesis, int place) const {
    const int seen = place + kShifts[hypothesis];
    return {tables_[hypothesis]->cell(seen), quad(tables_[hypothesis]->weights(seen))};
  }

 private:
  static constexpr auto kShifts = [] {
    std::array<int, kHypotheses> shifts{};
    for (std::size_t h = 0; h < kHypotheses; ++h) shifts[h] = Footprints::shift(kSteps[h]);
    return shifts;
  }();
  std::array<const Footprints*, kHypotheses> tables_;
};

/// The sums over all hypotheses' quads, which quad(h) makes.
template <class MakeQuad>
[[gnu::always_inline]] inline auto sums_of_hypotheses(MakeQuad quad) {
  using Quad = decltype(quad(std::size_t{0}));
  const Quad null = quad(0);
  Lanes<Quad> result;
  result.quads[0] = sums<Quad>(quad(5), quad(3), quad(6), quad(9));
  result.quads[1] = sums<Quad>(quad(1), null, quad(2), quad(10));
  result.quads[2] = sums<Quad>(quad(8), quad(4), quad(7), null);
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
  if (!(best - scores.of(0) > threshold * (best - worst))) return 0;
  std::size_t h = 0;
  while (scores.of(h) != best) ++h;
  return h;
}

inline Scores scaled(const Lanes<Double4>& raw, double unit) {
  Scores scores;
  for (std::size_t h = 0; h < scores.of.size(); ++h) scores.of[h] = unit * raw.of(h);
  return scores;
}

}  // namespace evbench::haste
