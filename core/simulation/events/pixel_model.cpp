#include "core/simulation/events/pixel_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/simulation/counter_random.hpp"

namespace evbench {
namespace {

/// What a pixel draws at random; each has a stream of its own.
enum class Draw : std::uint64_t { thresholds, kind, noise, jitter };

CounterRandom stream(std::uint64_t seed, std::uint64_t index, Draw draw) {
  return {seed, 4 * index + static_cast<std::uint64_t>(draw)};
}

float threshold(double nominal, double mismatch, double normal) {
  return static_cast<float>(std::max(0.1 * nominal, nominal + mismatch * normal));
}

}  // namespace

void SensorOptions::declare(OptionSet& set) {
  set.add("threshold_on", threshold_on, "rise of the log intensity that makes an ON event").range(0.01, 10.0);
  set.add("threshold_off", threshold_off, "fall of the log intensity that makes an OFF event").range(0.01, 10.0);
  set.add("threshold_mismatch", threshold_mismatch, "standard deviation of either threshold between pixels")
      .range(0.0, 1.0);
  set.add("refractory", refractory, "time after an event in which a pixel is blind [s]").range(0.0, 1.0);
  set.add("jitter", jitter, "standard deviation of an event's time [s]").range(0.0, 0.01);
  set.add("noise_rate", noise_rate, "noise events a pixel, of random polarity [Hz]").range(0.0, 1e4);
  set.add("leak_rate", leak_rate, "ON events a pixel when nothing changes [Hz]").range(0.0, 1e4);
  set.add("hot_share", hot_share, "share of hot pixels").range(0.0, 1.0);
  set.add("hot_rate", hot_rate, "noise events of a hot pixel [Hz]").range(0.0, 1e5);
  set.add("bandwidth", bandwidth,
          "of the low pass before the pixels, in proportion to the light but at least a tenth, for white [Hz]; 0: none")
      .range(0.0, 1e6);
}

Pixel::Pixel(const SensorOptions& options, std::uint64_t seed, std::uint64_t index, double t, double L)
    : t_(t), L_(L), reference_(L), blind_until_(t), next_noise_(t), seed_(seed), index_(index) {
  const CounterRandom thresholds = stream(seed, index, Draw::thresholds);
  on_ = threshold(options.threshold_on, options.threshold_mismatch, thresholds.normal(0));
  off_ = threshold(options.threshold_off, options.threshold_mismatch, thresholds.normal(1));
  leak_ = static_cast<float>(options.leak_rate) * on_;
  const CounterRandom kind = stream(seed, index, Draw::kind);
  const bool hot = kind.uniform(0) < options.hot_share;
  if (leak_ > 0.0F) reference_ -= on_ * kind.uniform(1);
  noise_rate_ = static_cast<float>(hot ? options.hot_rate : options.noise_rate);
  draw_next_noise();
}

void Pixel::draw_next_noise() {
  if (!(noise_rate_ > 0.0F)) {
    next_noise_ = std::numeric_limits<double>::infinity();
    return;
  }
  // The odd draws are the polarities.
  next_noise_ += stream(seed_, index_, Draw::noise).exponential(2 * noise_draws_++) / noise_rate_;
}

bool Pixel::fires(double t, double L) const {
  if (blind_ ? blind_until_ < t : next_noise_ <= t) return true;
  const double change = L - reference_ + leak_ * (t - t_);
  return !blind_ && (change >= on_ || change <= -off_);
}

Pixel::Quiet Pixel::quiet() const {
  constexpr double kLongest = 0.5;  // [s] that the leak is predicted, and the share of the threshold that it may take
  constexpr double kShare = 0.1, kMargin = 1e-5;  // margin: more than is lost by rounding
  constexpr float kFar = std::numeric_limits<float>::infinity();
  if (blind_) return {-kFar, kFar, std::nextafter(blind_until_, t_)};
  const double ahead = std::min({next_noise_ - t_, kLongest, leak_ > 0.0F ? kShare * on_ / leak_ : kLongest});
  return {static_cast<float>(reference_ - off_ + kMargin),
          static_cast<float>(reference_ + on_ - leak_ * ahead - kMargin), std::nextafter(t_ + ahead, t_)};
}

void Pixel::advance(const SensorOptions& options, double t, double L, std::vector<Event>& events) {
  const double from = t_, L_from = L_, slope = t > from ? (L - L_from) / (t - from) : 0.0;
  while (next_noise_ <= t) {
    run(options, next_noise_, L_from + slope * (next_noise_ - from), events);
    const bool on = (stream(seed_, index_, Draw::noise).bits(2 * noise_draws_ - 1) & 1) != 0;
    if (!blind_) emit(options, on, events);
    draw_next_noise();
  }
  run(options, t, L, events);
}

/// advance() between noise events.
void Pixel::run(const SensorOptions& options, double t, double L, std::vector<Event>& events) {
  const double slope = t > t_ ? (L - L_) / (t - t_) : 0.0;
  while (true) {
    if (blind_) {
      if (blind_until_ > t) break;
      if (blind_until_ > t_) {
        L_ += slope * (blind_until_ - t_);
        t_ = blind_until_;
      }
      reference_ = L_;
      blind_ = false;
    }
    const double rise = slope + leak_;
    const double to_threshold = (rise > 0.0 ? on_ : -off_) - (L_ - reference_);
    const double wait = rise == 0.0 ? std::numeric_limits<double>::infinity() : std::max(0.0, to_threshold / rise);
    if (!(t_ + wait <= t)) {
      reference_ -= leak_ * (t - t_);
      break;
    }
    t_ += wait;
    L_ += slope * wait;
    emit(options, rise > 0.0, events);
  }
  t_ = t;
  L_ = L;
}

void Pixel::emit(const SensorOptions& options, bool on, std::vector<Event>& events) {
  double t = t_;
  if (options.jitter > 0.0) {
    const double normal = stream(seed_, index_, Draw::jitter).normal(emitted_);
    t += options.jitter * std::clamp(normal, -4.0, 4.0);
  }
  ++emitted_;
  newest_ = std::max(newest_, static_cast<std::int64_t>(std::llround(t * 1e6)));
  events.push_back({.t = newest_, .on = on});
  blind_ = true;
  blind_until_ = t_ + options.refractory;
}

}  // namespace evbench
