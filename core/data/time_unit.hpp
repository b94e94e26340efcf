#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace evbench {

/// Unit of the times of a file.
enum class TimeUnit { unsaid, seconds, milliseconds, microseconds, nanoseconds };

inline constexpr std::array kTimeUnitNames{"auto", "s", "ms", "us", "ns"};

/// Replaces µ (UTF-8) by u.
std::string with_plain_micro(std::string text);

/// Parses a unit such as "[ns]", "usec", "µs" or "seconds"; none for other texts.
std::optional<TimeUnit> parse_time_unit(std::string_view text);

/// "microseconds".
std::string to_string(TimeUnit unit);

double per_second(TimeUnit unit);

/// The unit of times without one, from one of them: seconds below 10¹¹, nanoseconds from 10¹⁷ on (any other unit would
/// be after the year 5000). None in between: microseconds since 1970 and nanoseconds since a machine's start look
/// alike.
std::optional<TimeUnit> usual_time_unit(double time);

/// The unit other than seconds in which the times would meet a range [s]; none unless exactly one does.
std::optional<TimeUnit> unit_that_meets(double from, double to, double range_from, double range_to);

/// A phrase for messages about times [s] outside a range [s]: "go from 50637 to 5259582 s" and, if there is one, the
/// unit (as the value of an option) in which they would be about in the range.
std::string times_outside(double from, double to, double range_from, double range_to, const std::string& option);

}  // namespace evbench
