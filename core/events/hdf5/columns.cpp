#include "core/events/hdf5/columns.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

#include "core/events/bytes/event_words.hpp"

namespace evbench::hdf5 {
namespace {

constexpr double kMostTime = 2e18;    ///< [µs], so that neither an offset nor a zero makes it overflow
constexpr std::size_t kBlock = 1024;  ///< events at a time: what is between columns and events stays in the first cache

/// Columns in one type each, so that a loop for each column is vectorised; there are too many combinations of types for
/// a loop of their own.
struct Block {
  std::array<std::int64_t, kBlock> t;
  std::array<std::uint16_t, kBlock> x, y;
  std::array<std::uint8_t, kBlock> p;
};

/// Calls f(row, number) for `count` rows.
template <class F>
void for_each(const ColumnView& column, std::size_t count, F f) {
  column.values->visit([&](auto numbers) {
    const auto* const from = numbers.data() + column.first;
    if (column.step == 1) {
      for (std::size_t i = 0; i < count; ++i) f(i, from[i]);
    } else {
      for (std::size_t i = 0; i < count; ++i) f(i, from[i * column.step]);
    }
  });
}

template <class Number>
std::int64_t microseconds(Number t, std::int64_t offset) {
  if constexpr (std::is_floating_point_v<Number>) {
    // llround's result, up to 1 us beyond 142 years, in instructions that are vectorised.
    const double us = 1e6 * static_cast<double>(t);
    const bool is_time = std::abs(us) < kMostTime;
    const auto rounded = static_cast<std::int64_t>((is_time ? us : 0.0) + (us < 0.0 ? -0.5 : 0.5));
    return is_time ? rounded + offset : kBroken;
  } else if constexpr (sizeof(Number) < 8) {
    return static_cast<std::int64_t>(t) + offset;
  } else {
    constexpr auto kMost = static_cast<Number>(kMostTime);
    const bool is_time = t < kMost && (std::is_unsigned_v<Number> || t > Number(0) - kMost);
    return is_time ? static_cast<std::int64_t>(t) + offset : kBroken;
  }
}

/// Breaks the times of those that are no pixel's coordinate.
void read_pixels(const ColumnView& column, std::size_t count, std::uint16_t* pixels, std::int64_t* t) {
  for_each(column, count, [=](std::size_t i, auto number) {
    using Number = decltype(number);
    if constexpr (std::is_same_v<Number, std::uint8_t> || std::is_same_v<Number, std::uint16_t>) {
      pixels[i] = number;
    } else {
      const bool is_pixel = number >= Number(0) && static_cast<double>(number) <= 65535.0;
      pixels[i] = static_cast<std::uint16_t>(static_cast<int>(is_pixel ? number : Number(0)));
      t[i] = is_pixel ? t[i] : kBroken;
    }
  });
}

}  // namespace

bool to_events(const ColumnView& x, const ColumnView& y, const ColumnView& t, const ColumnView& p, std::int64_t offset,
               std::span<Event> events) {
  Block block{};
  std::int64_t* const block_t = block.t.data();
  std::uint8_t* const block_p = block.p.data();
  std::uint64_t broken = 0;
  for (std::size_t done = 0; done < events.size(); done += kBlock) {
    const std::size_t count = std::min(kBlock, events.size() - done);
    const auto rest = [&](const ColumnView& column) {
      return ColumnView{column.values, column.first + done * column.step, column.step};
    };
    for_each(rest(t), count, [=](std::size_t i, auto number) { block_t[i] = microseconds(number, offset); });
    read_pixels(rest(x), count, block.x.data(), block_t);
    read_pixels(rest(y), count, block.y.data(), block_t);
    for_each(rest(p), count, [=](std::size_t i, auto number) { block_p[i] = number > 0; });
    Event* const out = events.data() + done;
    for (std::size_t i = 0; i < count; ++i) {
      broken |= static_cast<std::uint64_t>(block.t[i] == kBroken);
      store_event(static_cast<std::uint64_t>(block.t[i]),
                  block.x[i] | std::uint64_t{block.y[i]} << 16 | std::uint64_t{block.p[i]} << 32, out + i);
    }
  }
  return broken == 0;
}

std::int64_t to_time(const ColumnView& t, std::size_t row, std::int64_t offset) {
  std::int64_t result = kBroken;
  t.values->visit([&](auto numbers) { result = microseconds(numbers[t.first + row * t.step], offset); });
  return result;
}

}  // namespace evbench::hdf5
