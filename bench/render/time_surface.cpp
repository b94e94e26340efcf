#include "bench/render/time_surface.hpp"

#include <algorithm>
#include <cmath>

namespace evbench {

cv::Mat1f time_surface(std::span<const Event> events, cv::Size size, std::int64_t t, double decay) {
  cv::Mat1f surface(size, 0.0F);
  for (const Event& event : events) {
    const double value = std::exp(-static_cast<double>(t - event.t) / decay);
    surface(event.y, event.x) = static_cast<float>(event.on ? value : -value);
  }
  return surface;
}

Picture draw_time_surface(const cv::Mat1f& surface, const Palette& palette) {
  Picture picture(surface.size());
  std::transform(surface.begin(), surface.end(), picture.begin(), [&](float value) {
    return blend(palette.background, value > 0.0F ? palette.on : palette.off, std::abs(value));
  });
  return picture;
}

}  // namespace evbench
