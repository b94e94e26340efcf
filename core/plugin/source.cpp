#include "core/plugin/source.hpp"

#include <cmath>

namespace evbench {

std::unique_ptr<EventStream> Source::events() const {
  std::unique_ptr<EventReader> reader = all_events();
  if (!reader) return nullptr;
  const TimeRange range = time_range();
  StreamOptions options;
  options.read.lenient = is_lenient();
  options.from = static_cast<std::int64_t>(std::ceil(range.from * 1e6 - 1e-3));
  options.to = static_cast<std::int64_t>(std::floor(range.to * 1e6 + 1e-3)) + 1;
  return std::make_unique<EventStream>(std::move(reader), "the source's events", options);
}

}  // namespace evbench
