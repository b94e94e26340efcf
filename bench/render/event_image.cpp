#include "bench/render/event_image.hpp"

namespace evbench {

Picture draw_events(std::span<const Event> events, cv::Size size, const Palette& palette) {
  Picture picture(size, palette.background);
  for (const Event& event : events) picture(event.y, event.x) = event.on ? palette.on : palette.off;
  return picture;
}

}  // namespace evbench
