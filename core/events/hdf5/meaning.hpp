#pragma once

#include <string>

#include "core/events/hdf5/table.hpp"

namespace evbench::hdf5 {

/// What the numbers of a table of events mean.
struct Meaning {
  TimeScale scale;
  std::string unit_origin;  ///< what tells the unit of time, for people
  bool unit_is_guessed = false;
  Darker darker = Darker::unsaid;
};

/// The unit of time is the one that is asked for, that an attribute says (find_time_unit()), or by the look of the
/// times: seconds where they have fractions, otherwise microseconds. An offset is in that unit, too. What stands for
/// darker is told by samples from the beginning, the middle and the end. Throws InputError where times are too late for
/// the unit that they look like, or their events fewer than one a second.
Meaning find_meaning(const File& file, const EventLayout& layout, const EventTable& table, TimeUnit asked);

}  // namespace evbench::hdf5
