#include "core/events/text/text_layout.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>

#include "core/data/columns.hpp"
#include "core/support/error.hpp"
#include "core/support/index.hpp"

namespace evbench {
namespace {

using Column = TextLayout::Column;

constexpr double kMostPixels = 65535.0;
const std::vector<Column> kTimeFirst{Column::t, Column::x, Column::y, Column::p};
const std::vector<Column> kTimeLast{Column::x, Column::y, Column::p, Column::t};

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> columns;
  for (auto column = next_column(line); !column.empty(); column = next_column(line)) columns.push_back(column);
  return columns;
}

/// "240 180", "%geometry:1280,720", "# geometry: 240x180".
void read_size(std::string_view line, TextLayout& layout) {
  int width = 0, height = 0;
  if (std::sscanf(std::string(line).c_str(), "%*[^0-9]%d%*[ ,x\t]%d", &width, &height) != 2 &&
      std::sscanf(std::string(line).c_str(), "%d%*[ ,x\t]%d", &width, &height) != 2) {
    return;
  }
  if (std::min(width, height) < 1 || std::max(width, height) > kMostPixels) return;
  layout.width = width;
  layout.height = height;
}

constexpr Quantity kQuantities[] = {kTime, {"x", "x.*"}, {"y", "y.*"}, {"p", "p.*|on"}};

/// Takes the columns' order, and the unit of time where it is said. False unless all four quantities are there, each
/// once.
bool take_names(const Columns& names, TextLayout& layout) {
  if (!names.ambiguity().empty() || names.nanoseconds()) return false;
  std::vector<Column> order(names.size(), Column::other);
  constexpr Column kColumns[] = {Column::t, Column::x, Column::y, Column::p};
  for (std::size_t i = 0; i < std::size(kQuantities); ++i) {
    const auto found = names.find(kQuantities[i].name);
    if (!found) return false;
    order[*found] = kColumns[i];
  }
  layout.columns = order;
  layout.unit_is_guessed = names.time_unit() == TimeUnit::unsaid;
  if (!layout.unit_is_guessed) layout.unit = names.time_unit();
  return true;
}

void read_names(std::string_view line, TextLayout& layout, const std::string& place) {
  const Columns names(line, kQuantities);
  if (take_names(names, layout)) return;
  if (!names.ambiguity().empty()) {
    throw InputError(
        fmt::format("{}: the columns are named {}; give --columns (source.columns in a run's config), "
                    "with - for one of them",
                    place, names.ambiguity()));
  }
  throw InputError(fmt::format("{}: names the columns \"{:.80}\"; expected time, x, y and polarity{}", place,
                               fmt::to_string(fmt::join(split(line), ", ")),
                               names.nanoseconds() ? ", the time in one column" : ""));
}

/// A line of numbers.
struct Row {
  std::vector<double> values;
  std::vector<bool> have_points;  ///< or exponents: not written as whole numbers
};
using Rows = std::vector<Row>;

/// Up to a thousand lines that are `columns` numbers each.
Rows read_rows(std::string_view text, std::size_t columns) {
  constexpr std::size_t kRows = 1000;
  Rows rows;
  while (!text.empty() && rows.size() < kRows) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    Row row;
    double number = 0.0;
    for (const std::string_view column : split(line)) {
      if (!parse_number(column, number)) continue;
      row.values.push_back(number);
      row.have_points.push_back(is_fractional(column));
    }
    if (row.values.size() == columns) rows.push_back(std::move(row));
  }
  return rows;
}

std::size_t time_column(const std::vector<Column>& order) {
  return index(std::ranges::find(order, Column::t) - order.begin());
}

/// Nobody writes pixels with a decimal point and times without.
bool fits(const Row& row, const std::vector<Column>& order) {
  for (std::size_t i = 0; i < order.size(); ++i) {
    const double value = row.values[i];
    const bool is_pixel = value >= 0.0 && value <= kMostPixels && value == std::floor(value) &&
                          (!row.have_points[i] || row.have_points[time_column(order)]);
    if ((order[i] == Column::x || order[i] == Column::y) && !is_pixel) return false;
    if (order[i] == Column::p && value != 0.0 && std::abs(value) != 1.0) return false;
  }
  return true;
}

/// The order that the more lines fit, but for one in twenty; times do not decrease, unless nothing fits then.
std::vector<Column> find_order(const Rows& rows, const std::string& place) {
  const auto fitting = [&](const std::vector<Column>& order, bool in_order) {
    double last = rows.front().values[time_column(order)];
    return std::ranges::count_if(rows, [&](const Row& row) {
      const double t = row.values[time_column(order)], before = std::exchange(last, t);
      // Out of order only what can't be a pixel: "x y t p" is neither.
      return fits(row, order) && (in_order ? t >= before : bool(row.have_points[time_column(order)]));
    });
  };
  bool both = false;
  for (const bool in_order : {true, false}) {
    const auto first = fitting(kTimeFirst, in_order), last = fitting(kTimeLast, in_order);
    if (first != last && 20 * std::max(first, last) >= 19 * std::ssize(rows)) {
      return first > last ? kTimeFirst : kTimeLast;
    }
    both |= first == last && first > 0;
  }
  throw InputError(
      fmt::format("{}: has lines like \"{}\", which {} \"t x y p\" {} \"x y p t\"; give --columns (source.columns in a "
                  "run's config)",
                  place, fmt::to_string(fmt::join(rows.front().values, " ")), both ? "may be" : "are neither",
                  both ? "and" : "nor"));
}

/// Without a name that says it.
TimeUnit find_unit(const Rows& rows, std::size_t time, const std::string& place) {
  constexpr double kLatestMicroseconds = 1e17;  // [µs], the year 5000: in nanoseconds that is 1973
  if (std::ranges::any_of(rows, [&](const Row& row) { return row.have_points[time]; })) return TimeUnit::seconds;
  if (rows.front().values[time] < kLatestMicroseconds) return TimeUnit::microseconds;
  throw InputError(
      fmt::format("{}: has the time {}, too late for microseconds; give --columns (source.columns in a run's config) "
                  "with t_ns, if it is that",
                  place, rows.front().values[time]));
}

}  // namespace

std::string_view next_column(std::string_view& line) {
  const auto separates = [](char c) { return c == ' ' || c == ',' || c == '\t' || c == ';' || c == '\r'; };
  const char* begin = line.data();
  const char* const last = begin + line.size();
  while (begin != last && separates(*begin)) ++begin;
  const char* end = begin;
  while (end != last && !separates(*end)) ++end;
  line = {end, last};
  return {begin, end};
}

bool is_passed_over(std::string_view line) {
  const std::string_view first = next_column(line);
  return first.empty() || first.starts_with('#') || first.starts_with('%');
}

bool is_fractional(std::string_view number) { return number.find_first_of(".eE") != std::string_view::npos; }

bool parse_number(std::string_view text, double& number) {
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size() && std::isfinite(number);
}

TextLayout detect_text_layout(std::string_view head, bool whole, const std::string& name, const std::string& asked) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  TextLayout layout;
  if (!asked.empty()) {
    read_names(asked, layout, fmt::format("{}: what is asked for", name));
    layout.origin = " (as asked for)";
  }
  if (!whole) head = head.substr(0, head.rfind('\n') + 1);
  layout.begin = head.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0;
  bool has_header = false;
  for (; layout.begin < head.size(); ++layout.lines) {
    const std::string_view line = head.substr(layout.begin, head.find('\n', layout.begin) - layout.begin);
    const std::string place = fmt::format("{}:{}", name, layout.lines + 1);
    const auto columns = split(line);
    double number = 0.0;
    if (is_passed_over(line)) {
      if (line.find("geometry") != std::string_view::npos) read_size(line, layout);
      TextLayout named = layout;
      if (layout.columns.empty() && take_names(Columns(line, kQuantities), named) &&
          named.columns.size() == kTimeFirst.size()) {
        layout = named;
        layout.origin = " (named in a comment)";
      }
    } else if (!has_header && std::ranges::none_of(columns, [&](auto c) { return parse_number(c, number); })) {
      has_header = true;
      if (asked.empty()) {
        read_names(line, layout, place);
        layout.origin = " (named in the file)";
      }
    } else if (columns.size() == 2 && layout.width == 0) {
      read_size(line, layout);
    } else {
      const std::size_t expected = layout.columns.empty() ? 4 : layout.columns.size();
      if (columns.size() != expected) {
        throw InputError(
            fmt::format("{}: has {} columns; expected {}", place, columns.size(),
                        layout.columns.empty()
                            ? "time, x, y and polarity; otherwise give --columns (source.columns in a run's config)"
                            : fmt::format("{}, as they are named", expected)));
      }
      const Rows rows = read_rows(head.substr(layout.begin), expected);
      if (rows.empty()) throw InputError(fmt::format("{}: is \"{:.80}\"; expected numbers", place, line));
      if (layout.columns.empty()) layout.columns = find_order(rows, place);
      if (layout.unit_is_guessed) layout.unit = find_unit(rows, time_column(layout.columns), place);
      return layout;
    }
    layout.begin = std::min(layout.begin + line.size() + 1, head.size());
  }
  throw InputError(fmt::format("{}: has no lines of events in its first {} bytes; expected time, x, y and polarity",
                               name, head.size()));
}

std::vector<std::pair<std::string, std::string>> TextLayout::description() const {
  constexpr const char* kColumns[] = {"t", "x", "y", "p", "-"};
  std::vector<std::string> order;
  for (const Column column : columns) order.push_back(kColumns[index(column)]);
  const char* why = unit == TimeUnit::seconds ? " (as they have a decimal point)" : " (as they are whole numbers)";
  return {{"columns", fmt::to_string(fmt::join(order, " ")) + origin},
          {"unit of time", to_string(unit) + (unit_is_guessed ? why : "")}};
}

}  // namespace evbench
