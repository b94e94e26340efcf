#include "bench/render/event_window.hpp"

#include <algorithm>

namespace evbench {

bool EventWindow::fill() {
  if (used_ < chunk_.size()) return true;
  used_ = 0;
  return stream_->read(chunk_);
}

std::optional<std::int64_t> EventWindow::next() {
  if (!fill()) return std::nullopt;
  return chunk_[used_].t;
}

std::span<const Event> EventWindow::before(std::int64_t t) {
  while (fill() && chunk_[used_].t < t) {
    const auto first = chunk_.begin() + static_cast<std::ptrdiff_t>(used_);
    const auto last = std::ranges::lower_bound(first, chunk_.end(), t, {}, &Event::t);
    window_.insert(window_.end(), first, last);
    used_ = static_cast<std::size_t>(last - chunk_.begin());
    trim(t);
  }
  trim(t);
  return window_;
}

/// Removes events before the window that ends at t.
void EventWindow::trim(std::int64_t t) {
  auto first = window_.begin();
  if (!extent_.count) {
    first = std::ranges::lower_bound(window_, t - extent_.duration, {}, &Event::t);
  } else if (window_.size() > *extent_.count) {
    first = window_.end() - static_cast<std::ptrdiff_t>(*extent_.count);
  }
  window_.erase(window_.begin(), first);
}

}  // namespace evbench
