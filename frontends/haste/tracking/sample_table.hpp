#pragma once

#include <array>

#include "frontends/haste/tracking/hypothesis_lanes.hpp"
#include "frontends/haste/tracking/quantised_template.hpp"
#include "frontends/haste/tracking/scoring_input.hpp"

namespace evbench::haste {

/// The template's value under each hypothesis around a state, at every position of an event. Neighbouring pixels are
/// neighbours in the table, so that nine hypotheses share one table and their values for an event are close together.
class SampleTable {
 public:
  /// Values are samples of the template times the weights' sum (kUnit).
  void make(const HypothesisFootprints& footprints, const QuantisedTemplate& sampled);

  /// The sum over all events in a window.
  Lanes<Double4> sum(const ScoringInput& input) const;

  /// The values for an event's index (Footprints::place).
  [[gnu::always_inline]] Lanes<Int4> at(int place) const {
    const int* null = &null_[index(place)];
    Lanes<Int4> result;
    result.quads[0] = load(null - Footprints::kSide - 1);
    result.quads[1] = load(null - 1);
    result.quads[2] = load(null + Footprints::kSide - 1);
    result.quads[0][3] = turned_[index(place)].plus;
    result.quads[1][3] = turned_[index(place)].minus;
    result.quads[2][3] = *null;
    return result;
  }

 private:
  static constexpr int kPlaces = Footprints::kSide * Footprints::kSide + 4;  ///< quads reach beyond the last
  struct Turned {
    int plus = 0, minus = 0;
  };

  using Int4At [[gnu::vector_size(16), gnu::aligned(4), gnu::may_alias]] = int;
  static Int4 load(const int* from) { return *reinterpret_cast<const Int4At*>(from); }

  static void store(int* to, Int4 values) { *reinterpret_cast<Int4At*>(to) = values; }

  const Footprints* made_for_ = nullptr;  ///< the null hypothesis' table
  std::array<int, kPlaces> null_{};
  std::array<Turned, kPlaces> turned_{};
};

}  // namespace evbench::haste
