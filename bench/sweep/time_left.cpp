#include "bench/sweep/time_left.hpp"

#include <algorithm>
#include <functional>
#include <queue>
#include <utility>

namespace evbench {

void RunDurations::add(const Traits& traits, double seconds) { done_.push_back({traits, seconds}); }

double RunDurations::expected(const Traits& traits) const {
  std::pair<bool, std::size_t> best{false, 0};
  double sum = 0.0;
  std::size_t count = 0;
  for (const Done& done : done_) {
    std::size_t common = 0;
    for (const std::string& value : done.traits.values) {
      if (std::ranges::find(traits.values, value) != traits.values.end()) ++common;
    }
    const std::pair similarity{done.traits.label == traits.label, common};
    if (count > 0 && similarity < best) continue;
    if (count == 0 || similarity > best) {
      best = similarity;
      sum = 0.0;
      count = 0;
    }
    sum += done.seconds;
    ++count;
  }
  return count == 0 ? 0.0 : sum / static_cast<double>(count);
}

double time_left(std::span<const double> seconds, std::size_t at_a_time) {
  std::priority_queue<double, std::vector<double>, std::greater<>> free_at;
  for (std::size_t i = 0; i < std::max<std::size_t>(at_a_time, 1); ++i) free_at.push(0.0);
  double last = 0.0;
  for (const double of_run : seconds) {
    const double end = free_at.top() + of_run;
    free_at.pop();
    free_at.push(end);
    last = std::max(last, end);
  }
  return last;
}

}  // namespace evbench
