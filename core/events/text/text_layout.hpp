#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/events/event_columns.hpp"

namespace evbench {

/// How a text file holds events: a line each, in columns separated by blanks, tabs, commas or semicolons.
struct TextLayout {
  EventOrder columns;
  TimeUnit unit = TimeUnit::seconds;
  bool unit_is_guessed = true;  ///< no name states it
  std::string origin;           ///< of the order of the columns, for messages; empty: found from their values
  std::size_t begin = 0;        ///< offset of the events [bytes]
  std::int64_t lines = 0;       ///< before the events
  int width = 0, height = 0;    ///< of the sensor [px], if a line before the events states it; 0: unknown

  /// For messages: order of the columns, unit of time.
  std::vector<std::pair<std::string, std::string>> description() const;
};

/// Finds the layout from the beginning of the file (`whole`: all of it; otherwise its last line may be cut). The events
/// may be preceded by comments (# or %), the sensor's size ("240 180", "%geometry:1280,720") and the columns' names
/// ("x,y,p,t", "timestamp_us", also in a comment: "# t[s] x y p"). Without names there are four columns, "t x y p" or
/// "x y p t", whichever the lines fit, with times in order. Unless the name of the time states a unit, times are
/// seconds if they are written with a decimal point (even if it is 0.000000), otherwise microseconds.
/// `columns`: names in their order, e.g. "x,y,p,t_us", in place of those in the file; empty: none. Throws InputError if
/// the lines cannot be events or fit both orders, or the columns' names do not name them.
TextLayout detect_text_layout(std::string_view head, bool whole, const std::string& name,
                              const std::string& columns = "");

/// A line without an event: blank, or a comment.
bool is_passed_over(std::string_view line);

/// Removes the next column from the beginning of a line; empty at its end. Columns are separated by blanks, tabs,
/// commas, semicolons and the carriage return.
std::string_view next_column(std::string_view& line);

/// Is a number written with a decimal point or an exponent?
bool is_fractional(std::string_view number);

/// Parses a finite number; false for anything else.
bool parse_number(std::string_view text, double& number);

}  // namespace evbench
