#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/events/event_columns.hpp"

namespace evbench {

/// How a text file holds events: a line each, columns between blanks, tabs, commas or semicolons.
struct TextLayout {
  EventOrder columns;
  TimeUnit unit = TimeUnit::seconds;
  bool unit_is_guessed = true;  ///< as no name says it
  std::string origin;           ///< what tells the order of the columns, for people; empty: their values
  std::size_t begin = 0;        ///< of the events [bytes]
  std::int64_t lines = 0;       ///< before the events
  int width = 0, height = 0;    ///< of the sensor [px], where a line before the events says it; 0: unknown

  /// For people: order of the columns, unit of time.
  std::vector<std::pair<std::string, std::string>> description() const;
};

/// Finds out by the beginning of the file (`whole`: all of it; otherwise its last line may be cut). Before the events
/// may stand comments (# or %), the sensor's size ("240 180", "%geometry:1280,720") and the columns' names ("x,y,p,t",
/// "timestamp_us", also in a comment: "# t[s] x y p"). Without names there are four columns, "t x y p" or "x y p t",
/// whichever the lines fit, times in order. Unless the name of time says a unit, times are seconds where they are
/// written with a decimal point (even if it is 0.000000), otherwise microseconds.
/// `columns`: names in their order, e.g. "x,y,p,t_us", in place of those in the file; empty: none. Throws InputError
/// when the lines cannot be events or may be either, or the columns' names do not name them.
TextLayout detect_text_layout(std::string_view head, bool whole, const std::string& name,
                              const std::string& columns = "");

/// A line without an event: blank, or a comment.
bool is_passed_over(std::string_view line);

/// Takes the next column off the beginning of a line; empty at its end. Blanks, tabs, commas, semicolons and the
/// carriage return lie between columns.
std::string_view next_column(std::string_view& line);

/// Is a number written with a decimal point or an exponent?
bool is_fractional(std::string_view number);

/// As a finite number; false for anything else.
bool parse_number(std::string_view text, double& number);

}  // namespace evbench
