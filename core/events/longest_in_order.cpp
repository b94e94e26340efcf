#include "core/events/longest_in_order.hpp"

#include <algorithm>
#include <limits>

namespace evbench {

std::vector<std::uint32_t> longest_in_order(std::span<const Event> events) {
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> ends;  // of the subsequence of each length that ends earliest
  std::vector<std::uint32_t> before(events.size(), kNone);
  for (std::uint32_t i = 0; i < events.size(); ++i) {
    auto place = ends.end();
    if (!ends.empty() && events[i].t < events[ends.back()].t) {
      place = std::upper_bound(ends.begin(), ends.end(), events[i].t,
                               [&](std::int64_t t, std::uint32_t end) { return t < events[end].t; });
    }
    if (place != ends.begin()) before[i] = *(place - 1);
    if (place == ends.end()) {
      ends.push_back(i);
    } else {
      *place = i;
    }
  }
  std::vector<std::uint32_t> indices(ends.size());
  for (std::uint32_t i = ends.empty() ? kNone : ends.back(), left = static_cast<std::uint32_t>(ends.size()); left > 0;
       i = before[i]) {
    indices[--left] = i;
  }
  return indices;
}

}  // namespace evbench
