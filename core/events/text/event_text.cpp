#include "core/events/text/event_text.hpp"

#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <utility>

#include "core/events/bytes/bytes.hpp"
#include "core/events/bytes/fault_count.hpp"
#include "core/events/event_time.hpp"
#include "core/support/index.hpp"

namespace evbench {
namespace {

using Column = EventColumn;

constexpr std::size_t kLongestLine = 1 << 16;
// How far after a line's beginning parse_common may read: half of it for where a column begins, half for the column.
constexpr std::ptrdiff_t kReach = 160;
constexpr std::uint64_t kPowers[] = {1, 10, 100, 1000, 10'000, 100'000, 1'000'000, 10'000'000, 100'000'000};
constexpr double kLatestTime = 9e18;  // [us], about what 64 bits hold

struct Digits {
  std::uint64_t value = 0;
  unsigned count = 0;
};

/// The decimal digits among the next eight characters, without a branch on their number.
Digits read_digits(const char* at) {
  auto digits = load<std::uint64_t>(reinterpret_cast<const std::byte*>(at)) ^ 0x3030303030303030u;
  const std::uint64_t others = ((digits + 0x7676767676767676u) | digits) & 0x8080808080808080u;
  const auto count = static_cast<unsigned>(std::countr_zero(others)) / 8;  // 8 when there are no others
  if (count == 0) return {};
  digits <<= 8 * (8 - count);  // as if zeros came first
  // Pairs, fours, all eight: each step adds to a half of a group ten, a hundred, ten thousand times the other.
  digits = (digits * ((std::uint64_t{10} << 8) + 1)) >> 8 & 0x00FF00FF00FF00FFu;
  digits = (digits * ((std::uint64_t{100} << 16) + 1)) >> 16 & 0x0000FFFF0000FFFFu;
  digits = (digits * ((std::uint64_t{10000} << 32) + 1)) >> 32;
  return {digits, count};
}

bool is_blank(char c) { return c == ' ' || c == '\t' || c == ',' || c == ';'; }

/// Parses at most 16 digits, and moves on.
bool read_integer(const char*& at, std::uint64_t& value) {
  Digits digits = read_digits(at);
  at += digits.count;
  value = digits.value;
  if (digits.count < 8) return digits.count > 0;
  digits = read_digits(at);
  at += digits.count;
  value = value * kPowers[digits.count] + digits.value;
  return true;
}

/// Time [µs].
bool read_seconds(const char*& at, std::int64_t& t) {
  constexpr std::uint64_t kMostSeconds = 1'000'000'000'000;
  constexpr int kMostFurther = 16;
  std::uint64_t whole = 0, fraction = 0;  // the fraction in 10 ns
  if (!read_integer(at, whole) || whole > kMostSeconds) return false;
  if (*at == '.') {
    const Digits digits = read_digits(++at);
    at += digits.count;
    fraction = digits.value * kPowers[8 - digits.count];
    // Further digits don't change the rounding to us.
    for (int i = 0; i < kMostFurther && digits.count == 8 && *at >= '0' && *at <= '9'; ++i) ++at;
  }
  t = static_cast<std::int64_t>(whole * 1'000'000 + (fraction + 50) / 100);
  return true;
}

bool read_time(const char*& at, TimeUnit unit, std::int64_t& t) {
  if (unit == TimeUnit::seconds) return read_seconds(at, t);
  std::uint64_t value = 0;
  if (unit != TimeUnit::microseconds || !read_integer(at, value)) return false;
  t = static_cast<std::int64_t>(value);
  return true;
}

bool read_coordinate(const char*& at, std::uint16_t& coordinate) {
  const Digits digits = read_digits(at);
  at += digits.count;
  coordinate = static_cast<std::uint16_t>(digits.value);
  return digits.count > 0 && digits.value <= 0xFFFF;
}

bool read_polarity(const char*& at, bool& on) {
  on = *at == '1';
  if (*at == '-') ++at;
  return *at == '0' || *at == '1' ? (++at, true) : false;
}

/// Time from any number of the unit; integers exactly.
bool parse_time(std::string_view text, TimeUnit unit, std::int64_t& t) {
  std::int64_t integer = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), integer);
  if (error == std::errc() && end == text.data() + text.size()) {
    return to_microseconds(integer, unit, t) && std::abs(static_cast<double>(t)) <= kLatestTime;
  }
  double number = 0.0;
  if (!parse_number(text, number)) return false;
  number *= 1e6 / per_second(unit);
  if (std::abs(number) > kLatestTime) return false;
  t = std::llround(number);
  return true;
}

bool parse_coordinate(std::string_view text, std::uint16_t& coordinate) {
  double number = 0.0;
  if (!parse_number(text, number) || number < 0.0 || number > 65535.0 || number != std::floor(number)) return false;
  coordinate = static_cast<std::uint16_t>(number);
  return true;
}

bool parse_polarity(std::string_view text, bool& on) {
  double number = 0.0;
  if (!parse_number(text, number) || (number != 0.0 && std::abs(number) != 1.0)) return false;
  on = number > 0.0;
  return true;
}

}  // namespace

/// Parses a line as nearly all are: plain decimals, no more columns. Moves to the next line; false leaves the line to
/// parse_any.
bool EventTextDecoder::parse_common(const char*& at, Event& event) const {
  const char* next = at;
  for (const Column column : layout_.columns) {
    while (is_blank(*next)) {
      if (++next - at > kReach / 2) return false;
    }
    bool good = false;
    switch (column) {
      case Column::t: good = read_time(next, layout_.unit, event.t); break;
      case Column::x: good = read_coordinate(next, event.x); break;
      case Column::y: good = read_coordinate(next, event.y); break;
      case Column::p: good = read_polarity(next, event.on); break;
      case Column::other: break;
    }
    if (!good) return false;
    if (!is_blank(*next) && *next != '\n' && *next != '\r') return false;
  }
  if (*next == '\r') ++next;
  if (*next != '\n') return false;
  at = next + 1;
  return true;
}

/// Whole numbers were taken for microseconds: a fraction shows that they are not.
bool EventTextDecoder::contradicts_guess(std::string_view time) const {
  return layout_.unit_is_guessed && layout_.unit == TimeUnit::microseconds && is_fractional(time);
}

bool EventTextDecoder::has_contradicting_time(std::string_view line) const {
  for (const Column column : layout_.columns) {
    const std::string_view text = next_column(line);
    if (column == Column::t) return contradicts_guess(text);
  }
  return false;
}

/// Parses any line that is an event.
bool EventTextDecoder::parse_any(std::string_view line, Event& event) const {
  for (const Column column : layout_.columns) {
    const std::string_view text = next_column(line);
    bool good = !text.empty();
    switch (column) {
      case Column::t: good = parse_time(text, layout_.unit, event.t) && !contradicts_guess(text); break;
      case Column::x: good = parse_coordinate(text, event.x); break;
      case Column::y: good = parse_coordinate(text, event.y); break;
      case Column::p: good = parse_polarity(text, event.on); break;
      case Column::other: break;
    }
    if (!good) return false;
  }
  return next_column(line).empty();
}

EventDecoder::Progress EventTextDecoder::decode(std::span<const std::byte> in, std::uint64_t, std::span<Event> out,
                                                Faults& faults) {
  const char* const begin = reinterpret_cast<const char*>(in.data());
  const char* const end = begin + in.size();
  const char* at = begin;
  FaultCount wrong, fractional, too_long;
  std::size_t count = 0;
  while (at < end && count < out.size()) {
    if (end - at > kReach && !in_long_line_ && parse_common(at, out[count])) {
      ++count;
      ++line_;
      continue;
    }
    const char* const newline = static_cast<const char*>(std::memchr(at, '\n', static_cast<std::size_t>(end - at)));
    if (newline == nullptr) {
      if (static_cast<std::size_t>(end - at) < kLongestLine) break;
      if (!in_long_line_) too_long.add(static_cast<std::uint64_t>(line_) + 1);
      in_long_line_ = true;
      at = end;
      break;
    }
    const std::string_view line(at, static_cast<std::size_t>(newline - at));
    ++line_;
    at = newline + 1;
    if (std::exchange(in_long_line_, false) || is_passed_over(line)) continue;
    if (parse_any(line, out[count])) {
      ++count;
    } else {
      (has_contradicting_time(line) ? fractional : wrong).add(static_cast<std::uint64_t>(line_));
    }
  }
  wrong.report(faults, "lines that are no event", "line");
  fractional.report(
      faults, "lines whose time has a fraction, unlike the first ones (are they seconds? --columns t_s,...)", "line");
  too_long.report(faults, "lines of more than 64 KiB", "line");
  return {static_cast<std::size_t>(at - begin), count};
}

std::size_t EventTextDecoder::finish(std::span<const std::byte> in, std::uint64_t offset, std::span<Event> out,
                                     Faults& faults) {
  std::vector<std::byte> line(in.begin(), in.end());
  if (line.empty()) return 0;
  line.push_back(std::byte{'\n'});
  return decode(line, offset, out, faults).events;
}

void EventTextDecoder::reset() {
  line_ = layout_.lines;
  in_long_line_ = false;
}

}  // namespace evbench
