#pragma once

#include <limits>
#include <memory>
#include <vector>

#include "core/events/reader.hpp"
#include "core/support/byte_source.hpp"
#include "core/support/error.hpp"

namespace evbench {

/// Any bytes as a recording: read twice, with the same events, or refused.
template <class Open>
int fuzz_reader(const std::uint8_t* data, std::size_t size, Open open) {
  const auto count = [](EventReader& reader) {
    std::size_t total = 0;
    for (std::vector<Event> events; reader.read(events);) total += events.size();
    return total;
  };
  try {
    const auto reader =
        open(std::make_unique<MemoryBytes>(std::as_bytes(std::span(data, size)), "fuzz"), ReadOptions());
    const std::size_t first = count(*reader);
    reader->seek(std::numeric_limits<std::int64_t>::min());
    if (count(*reader) != first) __builtin_trap();
  } catch (const InputError&) {
  }
  return 0;
}

}  // namespace evbench
