#pragma once

#include <chrono>
#include <string>

namespace evbench {

/// A time in ISO 8601, "2024-05-01T12:34:56.789Z". Texts sort like their times.
std::string utc_time(std::chrono::system_clock::time_point time);

}  // namespace evbench
