#include <algorithm>
#include <vector>

#include "core/support/median.hpp"
#include "eval/association.hpp"

namespace evbench {
namespace {

constexpr double kShortestGap = 0.1;  // [s]
constexpr double kLongestStep = 1.0;  // [s]
constexpr double kGapFactor = 3.0;    // times the median distance of stamps

struct Span {
  double from = 0.0, to = 0.0;
};

/// The time spans between gaps.
std::vector<Span> without_holes(std::span<const double> times) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < times.size(); ++i) steps.push_back(times[i] - times[i - 1]);
  if (steps.empty()) return {};
  const double gap = std::clamp(kGapFactor * median(steps), kShortestGap, kLongestStep);
  std::vector<Span> spans = {{times.front(), times.front()}};
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (steps[i] > gap) spans.push_back({times[i + 1], times[i + 1]});
    spans.back().to = times[i + 1];
  }
  return spans;
}

double total(const std::vector<Span>& spans) {
  double sum = 0.0;
  for (const Span& span : spans) sum += span.to - span.from;
  return sum;
}

/// Duration of the intersection; each list in time order, without overlaps.
double common(const std::vector<Span>& a, const std::vector<Span>& b) {
  double sum = 0.0;
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    sum += std::max(0.0, std::min(a[i].to, b[j].to) - std::max(a[i].from, b[j].from));
    if (a[i].to < b[j].to) {
      ++i;
    } else {
      ++j;
    }
  }
  return sum;
}

}  // namespace

double coverage(std::span<const double> ground_truth_times, std::span<const double> pair_times) {
  const std::vector<Span> truth = without_holes(ground_truth_times);
  const double whole = total(truth);
  return whole > 0.0 ? std::min(1.0, common(truth, without_holes(pair_times)) / whole) : 0.0;
}

}  // namespace evbench
