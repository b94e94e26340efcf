#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/events/event.hpp"

namespace evbench {

/// "1.234 million/s", of slow recordings "1234/s".
std::string rate_text(double events_per_second);

/// Histogram of events over time, in bounded memory for an unknown duration: bins of equal width, which doubles when
/// they run out.
class RateHistogram {
 public:
  static constexpr std::size_t kBins = 2048;  ///< at most

  /// In time order, as EventStream gives them.
  void add(std::span<const Event> events);

  double start() const { return static_cast<double>(start_) * 1e-6; }  ///< [s] of the first event
  double width() const { return static_cast<double>(width_) * 1e-6; }  ///< of a bin [s]

  /// Rate of each bin [events/s]. The last bin ends with its last event.
  std::vector<double> rates() const;

  /// Mean rates of `count` equal parts of the time from the first event to the last [events/s].
  std::vector<double> resampled(std::size_t count) const;

 private:
  void halve();

  std::vector<std::int64_t> bins_;
  std::int64_t start_ = 0, newest_ = 0;  ///< [µs]
  std::int64_t width_ = 1000;            ///< [µs]
};

/// One bar a rate, in eighths of a line, `rows` lines high, with the scale at the side and the times below.
std::string plot_rates(const std::vector<double>& rates, double start, double end, int rows = 4);

}  // namespace evbench
