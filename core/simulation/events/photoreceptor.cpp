#include "core/simulation/events/photoreceptor.hpp"

#include <algorithm>
#include <cmath>

#include "core/simulation/fast_math.hpp"
#include "core/support/index.hpp"

namespace evbench {
namespace {

/// The response to light that changes in a straight line during `length`, with the mean light's time constant τ:
/// with q = length / τ, light − change / q + (before − light_before + change / q) exp(−q). `rate`: 1 / τ at
/// intensity 1.
inline float pass(float before, float light_before, float light, float length, float rate) {
  constexpr float kFloor = 0.1F;
  const float intensity = fast_exp(std::clamp(0.5F * (light_before + light), -80.0F, 0.0F));
  const float q = std::min(80.0F, rate * (kFloor + (1.0F - kFloor) * intensity) * length);
  const float left = fast_exp(-q), change = light - light_before;
  const float lag = q > 1e-2F ? (1.0F - left) / q : 1.0F - q * (0.5F - q / 6.0F);
  return light - change * lag + (before - light_before) * left;
}

}  // namespace

Photoreceptor::Photoreceptor(std::unique_ptr<Brightness> light, double bandwidth)
    : light_(std::move(light)), rate_(static_cast<float>(2.0 * M_PI * bandwidth)) {}

void Photoreceptor::start(double t) {
  light_->start(t);
  t_ = t;
  image_.assign(light_->image().begin(), light_->image().end());
}

double Photoreceptor::advance(double limit) {
  last_light_.assign(light_->image().begin(), light_->image().end());
  const double end = light_->advance(limit);
  length_ = static_cast<float>(end - t_);
  t_ = end;
  std::swap(last_, image_);
  image_.resize(last_.size());
  const float *const light = light_->image().data(), *const last_light = last_light_.data();
  const float* const last = last_.data();
  float* const image = image_.data();
  const std::size_t size = last_.size();
  for (std::size_t i = 0; i < size; ++i) image[i] = pass(last[i], last_light[i], light[i], length_, rate_);
  return end;
}

float Photoreceptor::within(int x, int y, int part) const {
  const std::size_t i = index(y) * index(width()) + index(x);
  return pass(last_[i], last_light_[i], light_->within(x, y, part), length_ * static_cast<float>(part) / kParts, rate_);
}

}  // namespace evbench
