#include "core/simulation/time_spans.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/support/error.hpp"

namespace evbench {
namespace {

/// ∫ of the smooth step 3x² − 2x³ from 0 to x, x clamped to [0, 1].
double step_integral(double x) {
  const double c = std::clamp(x, 0.0, 1.0);
  return c * c * c * (1.0 - 0.5 * c);
}

void expect_apart(const std::vector<TimeSpan>& spans, const std::string& place, double gap) {
  for (std::size_t i = 1; i < spans.size(); ++i) {
    if (spans[i].from >= spans[i - 1].to + gap) continue;
    throw InputError(
        fmt::format("{}: the span from {} s begins less than {} s after the one before it, which ends at "
                    "{} s; expected spans in order and apart",
                    place, spans[i].from, gap, spans[i - 1].to));
  }
}

}  // namespace

std::vector<TimeSpan> parse_time_spans(const std::vector<double>& list, const std::string& place, double gap) {
  if (list.size() % 2 != 0) {
    throw InputError(fmt::format("{}: has {} numbers; expected pairs [from, to, from, to, ...]", place, list.size()));
  }
  std::vector<TimeSpan> spans;
  for (std::size_t i = 0; i < list.size(); i += 2) {
    const TimeSpan span{list[i], list[i + 1]};
    if (!(span.from < span.to)) {
      throw InputError(fmt::format("{}: the span {} to {} s is empty; expected from < to", place, span.from, span.to));
    }
    spans.push_back(span);
  }
  expect_apart(spans, place, gap);
  return spans;
}

std::vector<TimeSpan> merge_time_spans(std::vector<TimeSpan> a, const std::vector<TimeSpan>& b,
                                       const std::string& place, double gap) {
  a.insert(a.end(), b.begin(), b.end());
  std::ranges::sort(a, {}, &TimeSpan::from);
  expect_apart(a, place, gap);
  return a;
}

double StoppingClock::operator()(double t) const {
  double lost = 0.0;
  for (const auto& [from, to] : stops_) {
    lost += kRamp * step_integral((t - (from - kRamp)) / kRamp);  // slowing down
    lost += std::clamp(t - from, 0.0, to - from);                 // at rest
    const double speeding_up = std::clamp(t - to, 0.0, kRamp);
    lost += speeding_up - kRamp * step_integral(speeding_up / kRamp);
  }
  return t - lost;
}

}  // namespace evbench
