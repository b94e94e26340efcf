#pragma once

#include <cstdint>
#include <vector>

#include "core/events/event.hpp"
#include "core/plugin/options.hpp"

namespace evbench {

/// Options of the pixels of an event camera. Rates are per pixel.
struct SensorOptions {
  double threshold_on = 0.2, threshold_off = 0.2;
  double threshold_mismatch = 0.02;
  double refractory = 1e-4;
  double jitter = 0.0;
  double noise_rate = 0.05;
  double leak_rate = 0.1;
  double hot_share = 0.0, hot_rate = 100.0;
  double bandwidth = 0.0;

  void declare(OptionSet& set);
};

/// One pixel, as Lichtsteiner et al. 2008 built it and simulators model it (Rebecq et al. 2018, Hu et al. 2021): it
/// remembers the log intensity L at its last event and emits an event when L has risen by threshold_on or fallen by
/// threshold_off since. After an event it is blind for the refractory period and then remembers the L that it finds.
/// - Its thresholds differ from the nominal ones by Gaussian mismatch (at least a tenth of the nominal one remains).
/// - The junction leak of its reset switch moves the remembered L, so that ON events come at leak_rate on average even
///   when nothing changes.
/// - Noise makes events of random polarity, a Poisson process of noise_rate (of hot_rate in a hot pixel); they reset
///   the pixel as other events do.
/// - The times of all its events are off by Gaussian jitter of at most four standard deviations, but remain in order.
class Pixel {
 public:
  /// `index`: of the pixel, for its own streams of random numbers. It begins at time t [s] with L settled; if it leaks,
  /// at a random time before its next leak event.
  Pixel(const SensorOptions& options, std::uint64_t seed, std::uint64_t index, double t, double L);

  /// L changes in a straight line to its value at time t [s]: appends the events in between, without x and y.
  void advance(const SensorOptions& options, double t, double L, std::vector<Event>& events);

  /// Would advance() emit an event?
  bool fires(double t, double L) const;

  double log_intensity() const { return L_; }

  /// Range of L, and time, in which the pixel needs no update: nothing happens there, and skip() replaces advance().
  struct Quiet {
    float low, high;  ///< exclusive
    double until;     ///< [s]; inclusive

    bool holds(double t, float L) const { return t <= until && low < L && L < high; }
  };
  Quiet quiet() const;

  /// Sets L at time t, after a change in which nothing happened (see Quiet).
  void skip(double t, double L) {
    if (!blind_) reference_ -= leak_ * (t - t_);
    t_ = t;
    L_ = L;
  }

 private:
  void run(const SensorOptions& options, double t, double L, std::vector<Event>& events);
  void emit(const SensorOptions& options, bool on, std::vector<Event>& events);
  void draw_next_noise();

  double t_, L_;             ///< now
  double reference_;         ///< remembered log intensity
  double blind_until_;       ///< [s]; the reference is set then; in the past if it has been
  double next_noise_;        ///< [s]
  std::int64_t newest_ = 0;  ///< time of the newest event [µs]
  std::uint64_t seed_, index_;
  std::uint32_t noise_draws_ = 0, emitted_ = 0;
  float on_, off_;    ///< thresholds
  float leak_;        ///< [1/s]
  float noise_rate_;  ///< [Hz]
  bool blind_ = false;
};

}  // namespace evbench
