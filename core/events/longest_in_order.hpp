#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/events/event.hpp"

namespace evbench {

/// Indices of a longest subsequence of events whose times do not decrease: what is left when as few as possible are
/// taken out, so that one time that is far too late doesn't cost all that follow (patience sorting, Fredman, Discrete
/// Mathematics 11, 1975). O(n log n), linear where events are nearly in order.
std::vector<std::uint32_t> longest_in_order(std::span<const Event> events);

}  // namespace evbench
