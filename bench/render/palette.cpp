#include "bench/render/palette.hpp"

#include <algorithm>
#include <cmath>

namespace evbench {

Palette light_palette() {
  return {.background = {255, 255, 255}, .on = {38, 34, 214}, .off = {205, 92, 24}, .frame = {170, 170, 170}};
}

Palette dark_palette() {
  return {.background = {22, 17, 14}, .on = {84, 94, 255}, .off = {255, 168, 76}, .frame = {96, 90, 84}};
}

cv::Scalar scalar(const Colour& colour) { return {double(colour[0]), double(colour[1]), double(colour[2])}; }

Colour blend(const Colour& a, const Colour& b, double share) {
  share = std::clamp(share, 0.0, 1.0);
  Colour mixed;
  for (int i = 0; i < 3; ++i) {
    mixed[i] = static_cast<std::uint8_t>(std::lround((1.0 - share) * a[i] + share * b[i]));
  }
  return mixed;
}

}  // namespace evbench
