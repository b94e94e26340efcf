#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/data/time_unit.hpp"

namespace evbench {

/// The unit of events' times if nothing states it: seconds if they have fractions, otherwise microseconds. Throws
/// InputError, which names --columns as the remedy, if `time`, one of them, is too late for that unit.
TimeUnit guess_time_unit(double time, bool have_fractions, const std::string& place);

/// A sentence if `count` events in `duration` [µs] are fewer or more than event cameras produce. It names the unit in
/// which the rate would be plausible.
std::optional<std::string> implausible_rate(std::int64_t count, double duration, TimeUnit unit);

}  // namespace evbench
