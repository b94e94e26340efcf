#include "core/events/text/text_layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <span>

#include "core/events/event_columns.hpp"
#include "core/events/time_guess.hpp"
#include "core/support/error.hpp"
#include "core/support/index.hpp"

namespace evbench {
namespace {

using Column = EventColumn;

constexpr double kMostPixels = 65535.0;
const EventOrder kTextOrders[] = {{Column::t, Column::x, Column::y, Column::p},
                                  {Column::x, Column::y, Column::p, Column::t}};

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

/// Takes over the columns' order, and the unit of time if it is stated.
void take(const EventColumns& named, TextLayout& layout) {
  layout.columns = named.order;
  layout.unit_is_guessed = named.unit == TimeUnit::unsaid;
  if (!layout.unit_is_guessed) layout.unit = named.unit;
}

/// Up to a thousand lines of `columns` numbers each.
std::vector<EventRow> read_rows(std::string_view text, std::size_t columns) {
  constexpr std::size_t kRows = 1000;
  std::vector<EventRow> rows;
  while (!text.empty() && rows.size() < kRows) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    EventRow row;
    double number = 0.0;
    for (const std::string_view column : split(line)) {
      if (!parse_number(column, number)) continue;
      row.values.push_back(number);
      row.have_fractions.push_back(is_fractional(column));
    }
    if (row.values.size() == columns) rows.push_back(std::move(row));
  }
  return rows;
}

/// Finds the unit from the times if no name states it.
TimeUnit find_unit(std::span<const EventRow> rows, const EventOrder& order, const std::string& place) {
  const std::size_t time = index(std::ranges::find(order, Column::t) - order.begin());
  const bool fractions = std::ranges::any_of(rows, [&](const EventRow& row) { return row.have_fractions[time]; });
  return guess_time_unit(rows.front().values[time], fractions, place);
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
    take(named_event_columns(asked, fmt::format("{}: what is asked for", name)), layout);
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
      EventColumns named;
      if (layout.columns.empty() && read_event_columns(line, named) && named.order.size() == kTextOrders[0].size()) {
        take(named, layout);
        layout.origin = " (named in a comment)";
      }
    } else if (!has_header && std::ranges::none_of(columns, [&](auto c) { return parse_number(c, number); })) {
      has_header = true;
      if (asked.empty()) {
        take(named_event_columns(line, place), layout);
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
      const std::vector<EventRow> rows = read_rows(head.substr(layout.begin), expected);
      if (rows.empty()) throw InputError(fmt::format("{}: is \"{:.80}\"; expected numbers", place, line));
      if (layout.columns.empty()) layout.columns = find_event_order(rows, kTextOrders, place);
      if (layout.unit_is_guessed) layout.unit = find_unit(rows, layout.columns, place);
      return layout;
    }
    layout.begin = std::min(layout.begin + line.size() + 1, head.size());
  }
  throw InputError(fmt::format("{}: has no lines of events in its first {} bytes; expected time, x, y and polarity",
                               name, head.size()));
}

std::vector<std::pair<std::string, std::string>> TextLayout::description() const {
  const char* why = unit == TimeUnit::seconds ? " (as they have a decimal point)" : " (as they are whole numbers)";
  return {{"columns", to_string(columns) + origin}, {"unit of time", to_string(unit) + (unit_is_guessed ? why : "")}};
}

}  // namespace evbench
