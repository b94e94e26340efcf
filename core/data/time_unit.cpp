#include "core/data/time_unit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "core/support/index.hpp"

namespace evbench {
namespace {

constexpr std::array kFiner{TimeUnit::milliseconds, TimeUnit::microseconds, TimeUnit::nanoseconds};

/// Length of the intersection of two ranges over that of their union; < 0: they don't meet.
double overlap(double from_a, double to_a, double from_b, double to_b) {
  const double common = std::min(to_a, to_b) - std::max(from_a, from_b);
  const double together = std::max(to_a, to_b) - std::min(from_a, from_b);
  return together > 0.0 ? common / together : 1.0;
}

}  // namespace

std::string with_plain_micro(std::string text) {
  for (const char* micro : {"\xC2\xB5", "\xCE\xBC"}) {  // the micro sign and the Greek letter
    for (std::size_t at = text.find(micro); at != std::string::npos; at = text.find(micro)) text.replace(at, 2, "u");
  }
  return text;
}

std::optional<TimeUnit> parse_time_unit(std::string_view text) {
  std::string name;
  for (const char c : with_plain_micro(std::string(text))) {
    if (std::isalpha(static_cast<unsigned char>(c)) != 0) {
      name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
  }
  const auto is = [&](std::initializer_list<const char*> names) {
    return std::ranges::any_of(names, [&](const char* known) { return name == known; });
  };
  if (is({"s", "sec", "secs", "second", "seconds"})) return TimeUnit::seconds;
  if (is({"ms", "msec", "msecs", "millis", "millisec", "millisecs", "millisecond", "milliseconds"}))
    return TimeUnit::milliseconds;
  if (is({"us", "usec", "usecs", "micros", "microsec", "microsecs", "microsecond", "microseconds"}))
    return TimeUnit::microseconds;
  if (is({"ns", "nsec", "nsecs", "nanos", "nanosec", "nanosecs", "nanosecond", "nanoseconds"}))
    return TimeUnit::nanoseconds;
  return std::nullopt;
}

std::string to_string(TimeUnit unit) {
  constexpr std::array kNames{"seconds", "seconds", "milliseconds", "microseconds", "nanoseconds"};
  return kNames[index(unit)];
}

double per_second(TimeUnit unit) {
  constexpr std::array kCounts{1.0, 1.0, 1e3, 1e6, 1e9};
  return kCounts[index(unit)];
}

std::optional<TimeUnit> usual_time_unit(double time) {
  constexpr double kLatestSecond = 1e11, kEarliestNanosecond = 1e17;
  if (std::abs(time) >= kEarliestNanosecond) return TimeUnit::nanoseconds;
  if (std::abs(time) < kLatestSecond) return TimeUnit::seconds;
  return std::nullopt;
}

std::optional<TimeUnit> unit_that_meets(double from, double to, double range_from, double range_to) {
  std::optional<TimeUnit> found;
  for (const TimeUnit unit : kFiner) {
    if (overlap(from / per_second(unit), to / per_second(unit), range_from, range_to) < 0.0) continue;
    if (found) return std::nullopt;
    found = unit;
  }
  return found;
}

std::string times_outside(double from, double to, double range_from, double range_to, const std::string& option) {
  constexpr double kAboutThere = 0.01;
  const auto fit = [&](TimeUnit unit) {
    return overlap(from / per_second(unit), to / per_second(unit), range_from, range_to);
  };
  const TimeUnit best = *std::ranges::max_element(kFiner, {}, fit);
  const std::string text = fmt::format("go from {} to {} s", from, to);
  if (fit(best) < kAboutThere) return text;
  return text + fmt::format("; in {} ({}: {}) they would go from {} to {} s", to_string(best), option,
                            kTimeUnitNames[index(best)], from / per_second(best), to / per_second(best));
}

}  // namespace evbench
