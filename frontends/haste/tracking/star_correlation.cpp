#include "frontends/haste/tracking/star_correlation.hpp"

namespace evbench::haste {

void StarCorrelation::start(const ScoringInput& input) {
  samples_.make(HypothesisFootprints(input.grid.angle), QuantisedTemplate(input.learnt));
  scores_ = samples_.sum(input);
}

void StarCorrelation::update(const Event& newest, const Event& replaced, const ScoringInput& input) {
  add(scores_, samples_.at(input.place(newest)) - samples_.at(input.place(replaced)));
}

}  // namespace evbench::haste
