#include "frontends/haste/tracking/sample_table.hpp"

#include <algorithm>

namespace evbench::haste {

namespace {

constexpr std::size_t kPlus = 9, kMinus = 10;  // the hypotheses that are turned
static_assert(kSteps[kPlus].angle == 1 && kSteps[kMinus].angle == -1);

/// The samples of four places of an angle's table.
Int4 samples_of(const Footprints& footprints, const QuantisedTemplate& sampled, int place) {
  const auto product = [&](int seen) -> Int4 {
    return quad(footprints.weights(seen)) * Block<int>::load(&sampled.cells()[index(footprints.cell(seen))]);
  };
  return sums<Int4>(product(place), product(place + 1), product(place + 2), product(place + 3));
}

}  // namespace

void SampleTable::make(const HypothesisFootprints& footprints, const QuantisedTemplate& sampled) {
  const Footprints &null = footprints.table(0), &plus = footprints.table(kPlus), &minus = footprints.table(kMinus);
  if (&null != made_for_) {  // otherwise all that is not written below is zero
    null_.fill(0);
    turned_.fill({});
    made_for_ = &null;
  }
  for (std::size_t row = 0; row < Footprints::kSide; ++row) {
    for (int place = null.runs()[row].begin; place < null.runs()[row].end; place += 4) {
      store(&null_[index(place)], samples_of(null, sampled, place));
    }
    const int end = std::max(plus.runs()[row].end, minus.runs()[row].end);
    int place = std::min(plus.runs()[row].begin, minus.runs()[row].begin);
    if (place == 0) place = std::max(plus.runs()[row].begin, minus.runs()[row].begin);  // one of them is empty
    for (; place < end; place += 4) {
      const Int4 p = samples_of(plus, sampled, place), m = samples_of(minus, sampled, place);
      store(&turned_[index(place)].plus, __builtin_shufflevector(p, m, 0, 4, 1, 5));
      store(&turned_[index(place + 2)].plus, __builtin_shufflevector(p, m, 2, 6, 3, 7));
    }
  }
}

Lanes<Double4> SampleTable::sum(const ScoringInput& input) const {
  Lanes<Double4> result;
  for (int slot = 0; slot < kWindowSize; ++slot) add(result, at(input.place(input.window.slot(slot))));
  return result;
}

}  // namespace evbench::haste
