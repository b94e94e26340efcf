#include "frontends/str/batches.hpp"

#include <algorithm>
#include <cmath>

namespace evbench::str {
namespace {

std::int64_t microseconds_of(double seconds) { return std::llround(1e6 * seconds); }

}  // namespace

void BatchOptions::declare(OptionSet& set) {
  set.add("duration", duration, "a batch ends after this time [s]").range(1e-4, 10.0);
  set.add("events", events, "or earlier when it has so many events; 0: any number").range(0, 100'000'000);
  set.add("motion", motion,
          "or earlier when the image has moved by this, at the last batch's speed [px, mean]; 0: by any distance")
      .range(0.0, 1000.0);
}

Batches::Batches(const BatchOptions& options, double slice, std::int64_t from)
    : options_(options), slice_(slice), end_(from), longest_(options.duration) {}

void Batches::learn(bool found) {
  constexpr double kShortest = 0.125;  // of the duration: what fails there, too, is not too long
  if (found) {
    longest_ = std::min(options_.duration, 2.0 * longest_);
  } else {
    longest_ = 0.5 * last_ >= kShortest * options_.duration ? 0.5 * last_ : options_.duration;
  }
}

std::optional<Batch> Batches::next(std::int64_t until) {
  double duration = longest_;
  if (options_.motion > 0.0 && speed_ > 0.0) duration = std::min(duration, options_.motion / speed_);
  std::int64_t from = end_ - std::min(shared_, microseconds_of(0.5 * duration));
  auto first = std::ranges::lower_bound(events_, from, {}, &Event::t);
  std::int64_t to = from + microseconds_of(duration);
  const auto most = static_cast<std::ptrdiff_t>(options_.events);
  if (most > 0 && events_.end() - first >= most) to = std::min(to, first[most - 1].t + 1);
  constexpr std::int64_t kShortest = 1000;  // [µs]: without it, events that all come at once would stop the batches
  to = std::max(to, end_ + kShortest);
  if (to > until) {
    events_.erase(events_.begin(), std::ranges::lower_bound(events_, end_ - shared_, {}, &Event::t));
    return std::nullopt;
  }
  if (from < 2 * end_ - to) {  // its last slice must not begin before the last one's end
    from = 2 * end_ - to;
    first = std::ranges::lower_bound(events_, from, {}, &Event::t);
  }
  const auto last = std::ranges::lower_bound(first, events_.end(), to, {}, &Event::t);
  end_ = to;
  shared_ = static_cast<std::int64_t>(slice_ * static_cast<double>(to - from));
  last_ = 1e-6 * static_cast<double>(to - from);
  return Batch{{first, last}, from, to};
}

}  // namespace evbench::str
