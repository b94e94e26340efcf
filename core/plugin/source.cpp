#include "core/plugin/source.hpp"

#include <cmath>

#include "core/events/sensor_size.hpp"
#include "core/support/error.hpp"

namespace evbench {

std::unique_ptr<EventStream> SensorData::events() const {
  std::unique_ptr<EventReader> reader = all_events();
  if (!reader) return nullptr;
  if (camera().width <= 0 || camera().height <= 0) {
    throw InputError("the source's camera has no sensor size; expected width and height of at least one pixel");
  }
  check_same_sensor("the source's camera", camera(), reader->info());
  const TimeRange range = time_range();
  StreamOptions options;
  options.read.lenient = is_lenient();
  options.width = camera().width;
  options.height = camera().height;
  options.size_assumption = size_assumption();
  options.from = static_cast<std::int64_t>(std::ceil(range.from * 1e6 - 1e-3));
  options.to = static_cast<std::int64_t>(std::floor(range.to * 1e6 + 1e-3)) + 1;
  return std::make_unique<EventStream>(std::move(reader), "the source's events", options);
}

}  // namespace evbench
