#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace evbench {

/// What a file's times count.
enum class TimeUnit { unsaid, seconds, milliseconds, microseconds, nanoseconds };

inline constexpr std::array kTimeUnitNames{"auto", "s", "ms", "us", "ns"};

/// With u for µ, in UTF-8.
std::string with_plain_micro(std::string text);

/// "[ns]", "usec", "µs", "seconds"; none for anything else.
std::optional<TimeUnit> parse_time_unit(std::string_view text);

/// "microseconds".
std::string to_string(TimeUnit unit);

double per_second(TimeUnit unit);

/// Of times that say none, by one of them: seconds, or nanoseconds where it is 10¹⁷ or more, which is after the year
/// 5000 in any other unit. None from 10¹¹ on: those are no seconds, but microseconds since 1970 or nanoseconds since a
/// machine's start are alike.
std::optional<TimeUnit> usual_time_unit(double time);

/// The unit, other than seconds, in which times would meet a range [s]; none unless it is exactly one.
std::optional<TimeUnit> unit_that_meets(double from, double to, double range_from, double range_to);

/// For a file's times [s] that do not meet a range [s]: "go from 50637 to 5259582 s", and the unit, as the value of an
/// option, in which they would be about there, if there is one.
std::string times_beside(double from, double to, double range_from, double range_to, const std::string& option);

}  // namespace evbench
