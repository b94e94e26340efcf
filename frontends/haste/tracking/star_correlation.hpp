#pragma once

#include "frontends/haste/tracking/hypothesis_lanes.hpp"
#include "frontends/haste/tracking/quantised_template.hpp"
#include "frontends/haste/tracking/scoring_input.hpp"

namespace evbench::haste {

/// Scores of the variant haste_correlation_star: Σ over the window of the template, as it was at the last change of
/// state, where each hypothesis sees the event.
class StarCorrelation {
 public:
  void start(const ScoringInput& input);
  void change_to(std::size_t /*h*/, const ScoringInput& input) { start(input); }
  void update(int slot, const Event& /*replaced*/, const ScoringInput& input) {
    sample(slot, input.place(input.window.slot(slot)));
  }
  const Lanes<Double4>& raw() const { return scores_; }
  double unit(const ScoringInput& /*input*/) const {
    return 1.0 / (double{kWindowSize} * kWindowSize * kUnit * kUnit * QuantisedTemplate::kTemplateUnit);
  }

 private:
  void sample(int slot, int place);

  QuantisedTemplate template_;
  HypothesisFootprints footprints_;
  Lanes<Double4> scores_;
  std::array<Lanes<Int4>, kWindowSize> samples_{};  ///< by slot: what the events have in the scores
};

}  // namespace evbench::haste
