#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace evbench {

/// How a text file holds events: a line each, columns between blanks, tabs, commas or semicolons.
struct TextLayout {
  enum class Column : std::uint8_t { t, x, y, p, other };
  enum class Unit : std::uint8_t { seconds, milliseconds, microseconds, nanoseconds };

  std::vector<Column> columns;
  Unit unit = Unit::seconds;
  bool signed_polarity = false;  ///< -1 and 1 rather than 0 and 1
  char separator = ' ';
  enum class Origin : std::uint8_t { values, header, caller };
  Origin origin = Origin::values;  ///< what tells the order of the columns
  std::size_t begin = 0;           ///< of the events [bytes]
  std::int64_t lines = 0;          ///< before the events
  int width = 0, height = 0;       ///< of the sensor [px], where a line before the events says it; 0: unknown

  /// For people: order of the columns, separator, unit, polarity, names.
  std::vector<std::pair<std::string, std::string>> description() const;
};

/// Finds out by the beginning of the file (`whole`: all of it; otherwise its last line may be cut). Before the events
/// may stand comments (# or %), the sensor's size ("240 180", "%geometry:1280,720") and the columns' names ("x,y,p,t",
/// "timestamp_us"). Without names the columns are told by what they hold: polarity is -1, 0 or 1, pixels are integers,
/// time doesn't decrease. Unless its name says it, the unit is told by fractions and by the rate of events.
/// `columns`: names in their order, e.g. "x,y,p,t_us", in place of those in the file; empty: none. Without a unit
/// behind the name of time it is found as without names. Throws InputError when the lines cannot be events, or the
/// columns' names do not name them.
TextLayout detect_text_layout(std::string_view head, bool whole, const std::string& name,
                              const std::string& columns = "");

/// Of a line; blanks, tabs, commas, semicolons and the carriage return lie between columns.
std::vector<std::string_view> split_columns(std::string_view line);

/// As a finite number; false for anything else.
bool parse_number(std::string_view text, double& number);

}  // namespace evbench
