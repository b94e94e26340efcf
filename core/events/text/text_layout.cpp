#include "core/events/text/text_layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

#include "core/support/error.hpp"

namespace evbench {
namespace {

using Column = TextLayout::Column;
using Unit = TextLayout::Unit;
using Order = std::array<Column, 4>;

constexpr std::string_view kSeparators = " \t,;\r";
constexpr double kMostPixels = 65535.0;
// In the order of preference. Swapped x and y cannot be told.
constexpr Order kOrders[] = {{Column::t, Column::x, Column::y, Column::p},
                             {Column::x, Column::y, Column::p, Column::t},
                             {Column::x, Column::y, Column::t, Column::p},
                             {Column::t, Column::p, Column::x, Column::y},
                             {Column::p, Column::x, Column::y, Column::t}};

/// The lines of a text, one after the other.
class Lines {
 public:
  Lines(std::string_view text, bool whole) : text_(text), whole_(whole) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (text.starts_with(kByteOrderMark)) at_ = kByteOrderMark.size();
  }
  bool next(std::string_view& line) {
    const auto end = text_.find('\n', at_);
    if (at_ >= text_.size() || (end == std::string_view::npos && !whole_)) return false;
    line = text_.substr(at_, end == std::string_view::npos ? end : end - at_);
    at_ = end == std::string_view::npos ? text_.size() : end + 1;
    return true;
  }
  std::size_t position() const { return at_; }

 private:
  std::string_view text_;
  bool whole_;
  std::size_t at_ = 0;
};

bool is_number(std::string_view text) {
  double ignored = 0.0;
  return parse_number(text, ignored);
}

/// "240 180", or after "geometry" in a comment.
void read_size(const std::vector<std::string_view>& columns, TextLayout& layout) {
  double width = 0.0, height = 0.0;
  if (columns.size() != 2 || !parse_number(columns[0], width) || !parse_number(columns[1], height)) return;
  const auto fits = [](double side) { return side >= 1.0 && side <= kMostPixels && side == std::floor(side); };
  if (!fits(width) || !fits(height)) return;
  layout.width = static_cast<int>(width);
  layout.height = static_cast<int>(height);
}

void read_comment(std::string_view line, TextLayout& layout) {
  constexpr std::string_view kGeometry = "geometry";
  const auto at = line.find(kGeometry);
  if (at == std::string_view::npos) return;
  std::string size(line.substr(at + kGeometry.size()));
  std::replace_if(
      size.begin(), size.end(), [](char c) { return c == ':' || c == '=' || c == 'x'; }, ' ');
  read_size(split_columns(size), layout);
}

/// "x", "Timestamp_us", "t[ns]", "polarity": what it begins with, and a unit behind.
Column read_name(std::string_view text, std::optional<Unit>& unit) {
  std::string name;
  for (const char c : text) {
    if (c != '"' && c != '\'') name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  if (name.starts_with('x')) return Column::x;
  if (name.starts_with('y')) return Column::y;
  if (name.starts_with('p') || name == "on") return Column::p;
  if (!name.starts_with('t')) return Column::other;
  const auto behind = name.find_first_of("_[(");
  const std::string suffix = behind == std::string::npos ? "" : name.substr(behind + 1);
  if (suffix.starts_with("ns") || suffix.starts_with("nano")) unit = Unit::nanoseconds;
  if (suffix.starts_with("us") || suffix.starts_with("micro")) unit = Unit::microseconds;
  if (suffix.starts_with("ms") || suffix.starts_with("milli")) unit = Unit::milliseconds;
  if (suffix == "s" || suffix == "s]" || suffix == "s)" || suffix.starts_with("sec")) unit = Unit::seconds;
  return Column::t;
}

void read_names(const std::vector<std::string_view>& names, TextLayout& layout, std::optional<Unit>& unit,
                const std::string& place) {
  for (const std::string_view name : names) layout.columns.push_back(read_name(name, unit));
  for (const Column wanted : kOrders[0]) {
    if (std::count(layout.columns.begin(), layout.columns.end(), wanted) != 1) {
      throw InputError(fmt::format("{}: names the columns \"{:.80}\"; expected time, x, y and polarity, once each",
                                   place, fmt::to_string(fmt::join(names, ", "))));
    }
  }
}

using Rows = std::vector<std::vector<double>>;

std::size_t time_column(const Order& order) {
  return static_cast<std::size_t>(std::find(order.begin(), order.end(), Column::t) - order.begin());
}

bool is_possible(const std::vector<double>& row, const Order& order) {
  for (std::size_t i = 0; i < order.size(); ++i) {
    const double value = row[i];
    if (order[i] == Column::p && value != 0.0 && std::abs(value) != 1.0) return false;
    if ((order[i] == Column::x || order[i] == Column::y) &&
        (value < 0.0 || value > kMostPixels || value != std::floor(value))) {
      return false;
    }
  }
  return true;
}

/// May these columns be time, x, y, polarity, but for one line in twenty?
bool is_possible(const Rows& rows, const Order& order) {
  const std::size_t time = time_column(order);
  std::size_t wrong = 0;
  double last = -std::numeric_limits<double>::infinity();
  for (const auto& row : rows) {
    if (!is_possible(row, order) || row[time] < last) ++wrong;
    last = row[time];
  }
  return 20 * wrong <= rows.size();
}

/// Of the possible orders the one with the latest time.
void find_order(const Rows& rows, TextLayout& layout, const std::string& place) {
  const Order* best = nullptr;
  for (const Order& order : kOrders) {
    if (!is_possible(rows, order)) continue;
    if (best == nullptr || rows.back()[time_column(order)] > rows.back()[time_column(*best)]) best = &order;
  }
  if (best == nullptr) {
    throw InputError(
        fmt::format("{}: has lines like \"{}\"; expected time, x, y and polarity in some order, times that do "
                    "not decrease, or to be told the columns",
                    place, fmt::to_string(fmt::join(rows.front(), " "))));
  }
  layout.columns.assign(best->begin(), best->end());
}

/// Seconds where there are fractions, otherwise microseconds, unless the events were too slow for an event camera.
Unit find_unit(std::vector<double> times) {
  constexpr double kSlow = 100.0, kModerate = 2e4;  // events a second
  constexpr std::size_t kFew = 100;
  constexpr double kUnixNanoseconds = 1e17;  // later than 1973 in ns, than the year 5000 in us
  // Of the middle of them, as a few may be broken; a second, if times are seconds.
  std::sort(times.begin(), times.end());
  const std::size_t twentieth = times.size() / 20;
  const double span = times[times.size() - 1 - twentieth] - times[twentieth];
  const double rate = static_cast<double>(times.size() - 2 * twentieth) / std::max(span, 1e-12);
  const bool has_fractions = std::any_of(times.begin(), times.end(), [](double t) { return t != std::floor(t); });
  if (has_fractions) return rate < 0.1 && times.size() >= kFew ? Unit::microseconds : Unit::seconds;
  if (times[times.size() / 2] > kUnixNanoseconds) return Unit::nanoseconds;
  const bool in_thousands =
      std::all_of(times.begin(), times.end(), [](double t) { return std::fmod(t, 1000.0) == 0.0; });
  const bool slow = rate * 1e6 < (in_thousands ? kModerate : kSlow);
  return times.size() >= kFew && slow ? Unit::nanoseconds : Unit::microseconds;
}

/// Up to a thousand lines of numbers, beginning with `line`.
Rows read_rows(Lines& lines, std::string_view line, std::size_t columns) {
  constexpr std::size_t kRows = 1000;
  Rows rows;
  do {
    const auto texts = split_columns(line);
    std::vector<double> row(texts.size());
    bool good = texts.size() == columns;
    for (std::size_t i = 0; i < texts.size() && good; ++i) good = parse_number(texts[i], row[i]);
    if (good) rows.push_back(std::move(row));
  } while (rows.size() < kRows && lines.next(line));
  return rows;
}

void read_values(const Rows& rows, const std::optional<Unit>& unit, TextLayout& layout) {
  std::vector<double> times;
  for (const auto& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (layout.columns[i] == Column::t) times.push_back(row[i]);
      if (layout.columns[i] == Column::p && row[i] < 0.0) layout.signed_polarity = true;
    }
  }
  layout.unit = unit ? *unit : find_unit(times);
}

}  // namespace

std::vector<std::string_view> split_columns(std::string_view line) {
  std::vector<std::string_view> columns;
  for (std::size_t at = line.find_first_not_of(kSeparators); at != std::string_view::npos;) {
    const auto end = line.find_first_of(kSeparators, at);
    columns.push_back(line.substr(at, end == std::string_view::npos ? end : end - at));
    at = end == std::string_view::npos ? end : line.find_first_not_of(kSeparators, end);
  }
  return columns;
}

bool parse_number(std::string_view text, double& number) {
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size() && std::isfinite(number);
}

TextLayout detect_text_layout(std::string_view head, bool whole, const std::string& name, const std::string& asked) {
  using Origin = TextLayout::Origin;
  TextLayout layout;
  std::optional<Unit> unit;
  bool has_header = false;
  if (!asked.empty()) {
    read_names(split_columns(asked), layout, unit, fmt::format("{}: what is asked for", name));
    layout.origin = Origin::caller;
  }
  Lines lines(head, whole);
  layout.begin = lines.position();
  std::string_view line;
  for (; lines.next(line); ++layout.lines, layout.begin = lines.position()) {
    const std::string place = fmt::format("{}:{}", name, layout.lines + 1);
    const auto columns = split_columns(line);
    if (columns.empty()) continue;
    if (columns[0].starts_with('#') || columns[0].starts_with('%')) {
      read_comment(line, layout);
    } else if (!is_number(columns[0]) && !has_header) {
      has_header = true;
      if (layout.origin == Origin::caller) continue;
      read_names(columns, layout, unit, place);
      layout.origin = Origin::header;
    } else if (columns.size() == 2 && layout.width == 0) {
      read_size(columns, layout);
    } else {
      const bool has_names = layout.origin != Origin::values;
      if (columns.size() != (has_names ? layout.columns.size() : 4)) {
        throw InputError(fmt::format(
            "{}: has {} columns; expected {}", place, columns.size(),
            has_names ? fmt::format("{}, as they are named", layout.columns.size()) : "time, x, y and polarity"));
      }
      const auto separator = line.find_first_of(",;\t");
      layout.separator = separator == std::string_view::npos ? ' ' : line[separator];
      const Rows rows = read_rows(lines, line, columns.size());
      if (rows.empty()) throw InputError(fmt::format("{}: is \"{:.80}\"; expected numbers", place, line));
      if (!has_names) find_order(rows, layout, place);
      read_values(rows, unit, layout);
      return layout;
    }
  }
  throw InputError(fmt::format("{}: has no lines of events in its first {} bytes; expected time, x, y and polarity",
                               name, head.size()));
}

std::vector<std::pair<std::string, std::string>> TextLayout::description() const {
  constexpr const char* kColumns[] = {"t", "x", "y", "p", "-"};
  constexpr const char* kUnits[] = {"seconds", "milliseconds", "microseconds", "nanoseconds"};
  constexpr const char* kOrigins[] = {"", " (named in the file)", " (as asked for)"};
  std::vector<std::string> order;
  for (const Column column : columns) order.push_back(kColumns[static_cast<std::size_t>(column)]);
  return {{"columns", fmt::format("{}{}", fmt::join(order, " "), kOrigins[static_cast<std::size_t>(origin)])},
          {"separator", separator == ' '    ? "blank"
                        : separator == '\t' ? "tab"
                                            : std::string(1, separator)},
          {"unit of time", kUnits[static_cast<std::size_t>(unit)]},
          {"polarity", signed_polarity ? "-1, 1" : "0, 1"}};
}

}  // namespace evbench
