#pragma once

#include <string>

#include "core/events/hdf5/table.hpp"

namespace evbench::hdf5 {

/// What the numbers of a table of events mean.
struct Meaning {
  TimeScale scale;
  std::string unit_origin;  ///< how the unit of time is known, for messages
  bool unit_is_guessed = false;
  Darker darker = Darker::unsaid;
};

/// The time unit is the one that is asked for, or that an attribute states (find_time_unit()); otherwise it follows
/// from the times: seconds if they have fractions, otherwise microseconds. An offset has the same unit. The number for
/// darker is found from samples at the beginning, the middle and the end. Throws InputError if times are too late for
/// the unit that was guessed, or if it gives implausibly few events per second.
Meaning find_meaning(const File& file, const EventLayout& layout, const EventTable& table, TimeUnit asked);

}  // namespace evbench::hdf5
