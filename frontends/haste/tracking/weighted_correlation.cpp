#include "frontends/haste/tracking/weighted_correlation.hpp"

#include <cmath>

namespace evbench::haste {

const std::array<float, kWindowSize>& gaussian_weights() {
  static const std::array<float, kWindowSize> weights = [] {
    constexpr double kSigma = kWindowSize / 6.0;
    std::array<double, kWindowSize> values{};
    double sum = 0.0;
    for (int i = 0; i < kWindowSize; ++i) {
      const double z = (i - kWindowSize / 2) / kSigma;
      sum += values[index(i)] = std::exp(-0.5 * z * z);
    }
    std::array<float, kWindowSize> scaled{};
    for (std::size_t i = 0; i < scaled.size(); ++i) scaled[i] = static_cast<float>(values[i] * kWindowSize / sum);
    return scaled;
  }();
  return weights;
}

Lanes<Float4> WeightedCorrelation::sample(const Event& event, const ScoringInput& input) const {
  const int place = input.place(event);
  // Products of a float and a weight are exact in double: the same with and without fused multiply-add.
  const Lanes<Double4> exact = sums_of_hypotheses([&](std::size_t h) -> Double4 {
    const auto [cell, weights] = footprints_.of(h, place);
    return __builtin_convertvector(weights, Double4) *
           __builtin_convertvector(Block<float>::load(&input.learnt.cells()[index(cell)]), Double4);
  });
  Lanes<Float4> result;
  for (std::size_t i = 0; i < 3; ++i) result.quads[i] = __builtin_convertvector(exact.quads[i], Float4);
  return result;
}

void WeightedCorrelation::sum_up(const EventWindow& window) {
  scores_ = {};
  const auto& weights = gaussian_weights();
  for (int i = 0; i < kWindowSize; ++i) {
    const Lanes<Float4>& sampled = samples_[index(window.slot_of(i))];
    const double weight = weights[index(i)];
    for (std::size_t k = 0; k < 3; ++k) {
      scores_.quads[k] += weight * __builtin_convertvector(sampled.quads[k], Double4);
    }
  }
}

void WeightedCorrelation::start(const ScoringInput& input) {
  footprints_ = HypothesisFootprints(input.grid.angle);
  for (int slot = 0; slot < kWindowSize; ++slot) samples_[index(slot)] = sample(input.window.slot(slot), input);
  sum_up(input.window);
}

void WeightedCorrelation::update(const Event& newest, const Event& /*replaced*/, const ScoringInput& input) {
  if (resample_) {
    start(input);
    return;
  }
  samples_[index(input.window.slot_of(kWindowSize - 1))] = sample(newest, input);
  sum_up(input.window);
}

}  // namespace evbench::haste
