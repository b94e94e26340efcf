#pragma once

#include "frontends/haste/tracking/hypothesis_lanes.hpp"
#include "frontends/haste/tracking/sample_table.hpp"
#include "frontends/haste/tracking/scoring_input.hpp"

namespace evbench::haste {

/// Scores of the variant haste_correlation_star: the sum over the window's events of the template's value at the event
/// under each hypothesis. The template is that of the last change of state.
class StarCorrelation {
 public:
  void start(const ScoringInput& input);
  void change_to(std::size_t /*h*/, const ScoringInput& input) { start(input); }
  void update(const Event& newest, const Event& replaced, const ScoringInput& input);

  const Lanes<Double4>& raw() const { return scores_; }
  double unit(const ScoringInput& /*input*/) const {
    return 1.0 / (double{kWindowSize} * kWindowSize * kUnit * kUnit * QuantisedTemplate::kTemplateUnit);
  }

 private:
  SampleTable samples_;
  Lanes<Double4> scores_;
};

}  // namespace evbench::haste
