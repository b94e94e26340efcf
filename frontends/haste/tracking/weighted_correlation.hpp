#pragma once

#include <array>

#include "frontends/haste/tracking/hypothesis_lanes.hpp"
#include "frontends/haste/tracking/scoring_input.hpp"

namespace evbench::haste {

/// A Gaussian over the window's events, the middle one weighing most, sigma a sixth of the window; their mean is 1.
const std::array<float, kWindowSize>& gaussian_weights();

/// Scores of the variants correlation and haste_correlation: the sum over the window's events of their Gaussian weight
/// times the template's value at the event under each hypothesis.
class WeightedCorrelation {
 public:
  /// resample: all events in the window are sampled again as the template changes (correlation).
  explicit WeightedCorrelation(bool resample) : resample_(resample) {}

  void start(const ScoringInput& input);
  void change_to(std::size_t /*h*/, const ScoringInput& input) { start(input); }
  void update(const Event& newest, const Event& replaced, const ScoringInput& input);

  const Lanes<Double4>& raw() const { return scores_; }
  double unit(const ScoringInput& input) const {
    const double mass = input.learnt.mass();
    return mass > 0.0 ? 1.0 / (double{kWindowSize} * kUnit * mass) : 0.0;
  }

 private:
  Lanes<Float4> sample(const Event& event, const ScoringInput& input) const;
  void sum_up(const EventWindow& window);

  bool resample_;
  HypothesisFootprints footprints_;
  Lanes<Double4> scores_;
  std::array<Lanes<Float4>, kWindowSize> samples_{};  ///< by slot
};

}  // namespace evbench::haste
