#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <ctime>
#include <limits>
#include <vector>

#include "core/events/event.hpp"

namespace evbench {

/// How long a recording's events took to read.
struct Reading {
  std::int64_t events = 0;
  double wall_s = std::numeric_limits<double>::infinity();
  double processor_s = std::numeric_limits<double>::infinity();  ///< the relevant time on a machine with other load
};

inline double processor_seconds() {
  timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Best of three. `open` gives a pointer to something that reads chunks of events.
template <class Open>
Reading measure_reading(Open open) {
  Reading best;
  std::vector<Event> events;
  for (int i = 0; i < 3; ++i) {
    const auto start = std::chrono::steady_clock::now();
    const double processor_start = processor_seconds();
    const auto source = open();
    std::int64_t count = 0;
    while (source->read(events)) count += static_cast<std::int64_t>(events.size());
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    best = {count, std::min(best.wall_s, seconds), std::min(best.processor_s, processor_seconds() - processor_start)};
  }
  return best;
}

}  // namespace evbench
