#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/events/event.hpp"

namespace evbench {

/// Indices of a longest subsequence of events whose times do not decrease: the events that remain if as few as possible
/// are removed. A single time that is far too late then does not cost all events after it. Patience sorting (Fredman,
/// Discrete Mathematics 11, 1975): O(n log n), linear if events are nearly in order.
std::vector<std::uint32_t> longest_in_order(std::span<const Event> events);

}  // namespace evbench
