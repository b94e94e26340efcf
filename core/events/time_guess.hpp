#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/data/time_unit.hpp"

namespace evbench {

/// The unit of events' times where nothing says it: seconds where they have fractions, otherwise microseconds. Throws
/// InputError, which asks for --columns, where `time`, one of them, is too late for that unit.
TimeUnit guess_time_unit(double time, bool have_fractions, const std::string& place);

/// A sentence where `count` events in `duration` [µs] are fewer or more than event cameras give, which tells in which
/// other unit they would not be.
std::optional<std::string> doubtful_rate(std::int64_t count, double duration, TimeUnit unit);

}  // namespace evbench
