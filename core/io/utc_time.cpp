#include "core/io/utc_time.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

namespace evbench {

std::string utc_time(std::chrono::system_clock::time_point time) {
  const auto seconds = std::chrono::floor<std::chrono::seconds>(time);
  const auto milliseconds = std::chrono::duration_cast<std::chrono::milliseconds>(time - seconds).count();
  const auto civil = fmt::gmtime(std::chrono::system_clock::to_time_t(seconds));
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z", civil, milliseconds);
}

}  // namespace evbench
