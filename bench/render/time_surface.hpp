#pragma once

#include <span>

#include "bench/render/palette.hpp"
#include "core/events/event.hpp"

namespace evbench {

/// The surface of active events with exponential decay (Lagorce et al., HOTS, PAMI 2017): ±exp(−(t − t_newest)/decay)
/// at every pixel, with the sign of its newest event's polarity; 0 where there was none. Events come in time order, not
/// after t. `t` and `decay` in [µs].
cv::Mat1f time_surface(std::span<const Event> events, cv::Size size, std::int64_t t, double decay);

/// From the background at 0 to the polarities' colours at ±1.
Picture draw_time_surface(const cv::Mat1f& surface, const Palette& palette);

}  // namespace evbench
