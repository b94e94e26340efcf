#include "frontends/str/batches.hpp"

#include <algorithm>
#include <cmath>

namespace evbench::str {

Batches::Batches(const BatchOptions& options, double slice, std::int64_t from)
    : options_(options), slice_(slice), from_(from), longest_(options.duration) {}

void Batches::learn(bool found) { longest_ = std::min(options_.duration, found ? 2.0 * longest_ : 0.5 * last_); }

std::optional<Batch> Batches::next(std::int64_t until) {
  double duration = longest_;
  if (options_.motion > 0.0 && speed_ > 0.0) duration = std::min(duration, options_.motion / speed_);
  std::int64_t to = from_ + std::llround(1e6 * duration);
  const auto most = static_cast<std::size_t>(options_.events);
  if (most > 0 && events_.size() - begin_ >= most) to = std::min(to, events_[begin_ + most - 1].t + 1);
  constexpr std::int64_t kShortest = 1000;  // [µs]: a batch of events that all come at once would not get on
  to = std::max(to, from_ + kShortest);
  if (to > until) {
    events_.erase(events_.begin(), events_.begin() + static_cast<std::ptrdiff_t>(begin_));
    begin_ = 0;
    return std::nullopt;
  }
  const auto first = events_.begin() + static_cast<std::ptrdiff_t>(begin_);
  const auto last = std::ranges::lower_bound(first, events_.end(), to, {}, &Event::t);
  const Batch batch{{first, last}, from_, to};
  last_ = 1e-6 * static_cast<double>(to - from_);
  from_ = to - static_cast<std::int64_t>(slice_ * static_cast<double>(to - from_));
  begin_ = static_cast<std::size_t>(std::ranges::lower_bound(first, last, from_, {}, &Event::t) - events_.begin());
  return batch;
}

}  // namespace evbench::str
