#pragma once

#include <string>
#include <vector>

namespace evbench {

struct TimeSpan {
  double from = 0.0, to = 0.0;  ///< [s]
};

/// Spans from an option's flat list [from, to, from, to, ...]. Throws InputError, naming `place`, for an odd count, an
/// empty span, and spans that are not in order or nearer than `gap` [s] to each other.
std::vector<TimeSpan> parse_time_spans(const std::vector<double>& list, const std::string& place, double gap = 0.0);

/// Both lists as one, in order. Throws InputError, naming `place`, where they overlap or are nearer than `gap` [s].
std::vector<TimeSpan> merge_time_spans(std::vector<TimeSpan> a, const std::vector<TimeSpan>& b,
                                       const std::string& place, double gap);

/// A clock that runs with time but stops inside the given spans. It slows down and speeds up smoothly (once
/// continuously differentiable rate) over kRamp [s] on either side. A motion that is read by it comes to rest.
class StoppingClock {
 public:
  static constexpr double kRamp = 0.2;

  StoppingClock() = default;
  /// Spans in order and at least two ramps apart.
  explicit StoppingClock(std::vector<TimeSpan> stops) : stops_(std::move(stops)) {}

  double operator()(double t) const;

 private:
  std::vector<TimeSpan> stops_;
};

}  // namespace evbench
