#pragma once

#include <span>

#include "core/events/recent_events.hpp"
#include "core/geometry/types.hpp"

namespace evbench::haste {

/// The newest events that fill the window of a tracker at `pixel` [px], in time order; all, where they are too few.
std::span<const Event> window_at(const Vector2& pixel, const RecentEvents& recent);

}  // namespace evbench::haste
