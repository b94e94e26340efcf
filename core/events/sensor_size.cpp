#include "core/events/sensor_size.hpp"

#include <fmt/format.h>

#include "core/support/error.hpp"

namespace evbench {

void check_sensor_size(const std::string& path, int width, int height) {
  constexpr std::int64_t kMost = 64'000'000;
  if (std::int64_t{width} * height <= kMost) return;
  throw InputError(fmt::format("{}: a sensor of {}x{} pixels; expected {} million pixels at most", path, width, height,
                               kMost / 1'000'000));
}

void check_same_sensor(const std::string& place, const Camera& camera, const StreamInfo& recording) {
  const bool both = camera.width > 0 && camera.height > 0 && recording.width > 0 && recording.height > 0;
  if (!both || recording.size_assumed) return;
  if (camera.width == recording.width && camera.height == recording.height) return;
  throw InputError(
      fmt::format("{} is of a sensor of {}x{} pixels, the recording of one of {}x{}; expected those of one camera",
                  place, camera.width, camera.height, recording.width, recording.height));
}

}  // namespace evbench
