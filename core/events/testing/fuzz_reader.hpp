#pragma once

#include <limits>
#include <memory>
#include <vector>

#include "core/events/reader.hpp"
#include "core/io/byte_source.hpp"
#include "core/support/error.hpp"

namespace evbench {

/// Uses all functions of a reader. Reading twice from the beginning must give the same events: otherwise the program
/// ends, as a finding.
inline void exercise(EventReader& reader) {
  constexpr std::int64_t kBeginning = std::numeric_limits<std::int64_t>::min();
  std::int64_t first = 0, last = 0;
  const auto count = [&] {
    std::size_t total = 0;
    for (std::vector<Event> events; reader.read(events); total += events.size()) {
      if (total == 0) first = events.front().t;
      last = events.back().t;
    }
    return total;
  };
  const std::size_t all = count();
  reader.seek(kBeginning);
  if (count() != all) __builtin_trap();
  for (const std::int64_t t : {first / 2 + last / 2, last, kBeginning, std::numeric_limits<std::int64_t>::max()}) {
    std::vector<Event> events;
    reader.seek(t);
    reader.read(events);
  }
  reader.ground_truth();
  reader.calibration();
}

/// Reads any bytes as a recording; they may be refused.
template <class Open>
int fuzz_reader(const std::uint8_t* data, std::size_t size, Open open) {
  try {
    const auto reader =
        open(std::make_unique<MemoryBytes>(std::as_bytes(std::span(data, size)), "fuzz"), ReadOptions());
    exercise(*reader);
  } catch (const InputError&) {
  }
  return 0;
}

}  // namespace evbench
