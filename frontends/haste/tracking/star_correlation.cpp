#include "frontends/haste/tracking/star_correlation.hpp"

namespace evbench::haste {

void StarCorrelation::start(const ScoringInput& input) {
  template_ = QuantisedTemplate(input.learnt);
  footprints_ = HypothesisFootprints(input.grid.angle);
  scores_ = {};
  samples_ = {};
  for (int slot = 0; slot < kWindowSize; ++slot) sample(slot, input.place(input.window.slot(slot)));
}

void StarCorrelation::sample(int slot, int place) {
  const Lanes<Int4> newest = template_.sample(footprints_, place);
  Lanes<Int4>& sampled = samples_[index(slot)];
  for (std::size_t i = 0; i < 3; ++i) {
    scores_.quads[i] += __builtin_convertvector(newest.quads[i] - sampled.quads[i], Double4);
  }
  sampled = newest;
}

}  // namespace evbench::haste
