#pragma once

#include <chrono>
#include <string>

namespace evbench {

/// A time as ISO 8601 has it, "2024-05-01T12:34:56.789Z": later times are later texts.
std::string utc_time(std::chrono::system_clock::time_point time);

}  // namespace evbench
