#pragma once

#include <cstdint>

#include "bench/render/palette.hpp"

namespace evbench {

/// Writes a time [µs] into the picture's lower left corner, in seconds.
void draw_time(std::int64_t t, const Palette& palette, Picture& picture);

}  // namespace evbench
