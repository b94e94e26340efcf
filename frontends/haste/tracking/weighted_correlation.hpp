#pragma once

#include <array>

#include "frontends/haste/tracking/hypothesis_lanes.hpp"
#include "frontends/haste/tracking/scoring_input.hpp"

namespace evbench::haste {

/// A Gaussian over the window's events, the middle one weighing most, sigma a sixth of the window; their mean is 1.
const std::array<float, kWindowSize>& gaussian_weights();

/// Scores of the variants correlation and haste_correlation: Σ over the window of the events' Gaussian weights times
/// the template where each hypothesis sees the event.
class WeightedCorrelation {
 public:
  /// resample: the events in the window follow what the template learns (correlation).
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
