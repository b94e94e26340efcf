#pragma once

#include <span>

#include "bench/render/palette.hpp"
#include "core/events/event.hpp"

namespace evbench {

/// A pixel has the colour of its newest event's polarity, or the background's. Events lie within `size`.
Picture draw_events(std::span<const Event> events, cv::Size size, const Palette& palette);

}  // namespace evbench
