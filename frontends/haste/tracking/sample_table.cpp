#include "frontends/haste/tracking/sample_table.hpp"

namespace evbench::haste {

namespace {

constexpr std::size_t kPlus = 9, kMinus = 10;  // the hypotheses that are turned
static_assert(kSteps[kPlus].angle == 1 && kSteps[kMinus].angle == -1);

/// Calls take(place, samples) for groups of four places, until all have come where an angle's samples may not be zero.
template <class Take>
void for_samples(const Footprints& footprints, const QuantisedTemplate& sampled, Take take) {
  const auto product = [&](int place) -> Int4 {
    return quad(footprints.weights(place)) * Block<int>::load(&sampled.cells()[index(footprints.cell(place))]);
  };
  for (const auto& [begin, end] : footprints.runs()) {
    for (int place = begin; place < end; place += 4) {
      take(place, sums<Int4>(product(place), product(place + 1), product(place + 2), product(place + 3)));
    }
  }
}

}  // namespace

void SampleTable::make(const HypothesisFootprints& footprints, const QuantisedTemplate& sampled) {
  null_.fill(0);
  turned_.fill({});
  for_samples(footprints.table(0), sampled,
              [&](int place, Int4 samples) { *reinterpret_cast<Int4At*>(&null_[index(place)]) = samples; });
  for_samples(footprints.table(kPlus), sampled, [&](int place, Int4 samples) {
    for (int i = 0; i < 4; ++i) turned_[index(place + i)].plus = samples[i];
  });
  for_samples(footprints.table(kMinus), sampled, [&](int place, Int4 samples) {
    for (int i = 0; i < 4; ++i) turned_[index(place + i)].minus = samples[i];
  });
}

Lanes<Double4> SampleTable::sum(const ScoringInput& input) const {
  Lanes<Double4> result;
  for (int slot = 0; slot < kWindowSize; ++slot) add(result, at(input.place(input.window.slot(slot))));
  return result;
}

}  // namespace evbench::haste
