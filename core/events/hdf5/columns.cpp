#include "core/events/hdf5/columns.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>
#include <utility>

#include "core/events/bytes/event_words.hpp"
#include "core/events/event_time.hpp"

namespace evbench::hdf5 {
namespace {

constexpr double kMostTime = 2e18;    ///< [µs], so that neither an offset nor a zero makes it overflow
constexpr std::size_t kBlock = 1024;  ///< events at a time: intermediate values stay in the first-level cache

/// Columns converted to one type each, so that a loop for each column is vectorised: there are too many combinations of
/// types for a loop each.
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

template <TimeUnit unit, class Number>
std::int64_t microseconds(Number t, std::int64_t offset) {
  if constexpr (std::is_floating_point_v<Number>) {
    // llround's result, up to 1 us beyond 142 years, in instructions that are vectorised.
    constexpr double kFactor = unit == TimeUnit::seconds        ? 1e6
                               : unit == TimeUnit::milliseconds ? 1e3
                               : unit == TimeUnit::microseconds ? 1.0
                                                                : 1e-3;
    const double us = kFactor * static_cast<double>(t);
    const bool is_time = std::abs(us) < kMostTime;
    const auto rounded = static_cast<std::int64_t>((is_time ? us : 0.0) + (us < 0.0 ? -0.5 : 0.5));
    return is_time ? rounded + offset : kBroken;
  } else if constexpr (sizeof(Number) < 8 && unit == TimeUnit::microseconds) {
    return static_cast<std::int64_t>(t) + offset;
  } else {
    constexpr auto kMost = static_cast<std::int64_t>(kMostTime);
    std::int64_t us = 0;
    const bool fits = std::in_range<std::int64_t>(t) && to_microseconds(static_cast<std::int64_t>(t), unit, us);
    return fits && us < kMost && us > -kMost ? us + offset : kBroken;
  }
}

/// Calls f(microseconds) with the function of a unit.
template <class F>
void with_unit(TimeUnit unit, F f) {
  const auto call = [&]<TimeUnit known>() {
    f([](auto t, std::int64_t offset) { return microseconds<known>(t, offset); });
  };
  switch (unit) {
    case TimeUnit::seconds: return call.template operator()<TimeUnit::seconds>();
    case TimeUnit::milliseconds: return call.template operator()<TimeUnit::milliseconds>();
    case TimeUnit::nanoseconds: return call.template operator()<TimeUnit::nanoseconds>();
    default: return call.template operator()<TimeUnit::microseconds>();
  }
}

template <class Number>
bool is_minus_one(Number number) {
  if constexpr (std::is_floating_point_v<Number>) {
    return number == Number(-1) || number == Number(0xFF) || number == Number(0xFFFF) || number == Number(0xFFFFFFFF);
  } else {
    const auto bits = static_cast<std::uint64_t>(number);  // sign extended
    return bits == 0xFF || bits == 0xFFFF || bits == 0xFFFFFFFF || bits == ~std::uint64_t{0};
  }
}

/// Marks events broken whose polarity is none.
void read_polarities(const ColumnView& column, std::size_t count, Darker darker, std::uint8_t* p, std::int64_t* t) {
  const bool zero = darker != Darker::minus_one, minus_one = darker != Darker::zero;
  for_each(column, count, [=](std::size_t i, auto number) {
    const bool is_off = (zero && number == 0) || (minus_one && is_minus_one(number));
    p[i] = number == 1;
    t[i] = number == 1 || is_off || t[i] == kBroken ? t[i] : kNoPolarity;
  });
}

/// Marks events broken whose coordinates are no pixel's.
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

void DarkerCount::add(const ColumnView& p, std::size_t count) {
  for_each(p, count, [&](std::size_t, auto number) {
    zeros_ += number == 0 ? 1 : 0;
    minus_ones_ += is_minus_one(number) ? 1 : 0;
  });
}

Darker DarkerCount::darker() const {
  if (zeros_ + minus_ones_ == 0) return Darker::unsaid;
  return zeros_ >= minus_ones_ ? Darker::zero : Darker::minus_one;
}

bool to_events(const ColumnViews& columns, const TimeScale& scale, Darker darker, std::span<Event> events) {
  Block block{};
  std::int64_t* const block_t = block.t.data();
  std::uint64_t broken = 0;
  for (std::size_t done = 0; done < events.size(); done += kBlock) {
    const std::size_t count = std::min(kBlock, events.size() - done);
    const auto rest = [&](const ColumnView& column) {
      return ColumnView{column.values, column.first + done * column.step, column.step};
    };
    with_unit(scale.unit, [&, offset = scale.offset](auto to_us) {
      for_each(rest(columns.t), count, [=](std::size_t i, auto number) { block_t[i] = to_us(number, offset); });
    });
    read_pixels(rest(columns.x), count, block.x.data(), block_t);
    read_pixels(rest(columns.y), count, block.y.data(), block_t);
    read_polarities(rest(columns.p), count, darker, block.p.data(), block_t);
    Event* const out = events.data() + done;
    for (std::size_t i = 0; i < count; ++i) {
      broken |= static_cast<std::uint64_t>(block.t[i] <= kNoPolarity);
      store_event(static_cast<std::uint64_t>(block.t[i]),
                  block.x[i] | std::uint64_t{block.y[i]} << 16 | std::uint64_t{block.p[i]} << 32, out + i);
    }
  }
  return broken == 0;
}

std::int64_t to_time(const ColumnView& t, std::size_t row, const TimeScale& scale) {
  std::int64_t result = kBroken;
  t.values->visit([&](auto numbers) {
    with_unit(scale.unit, [&](auto to_us) { result = to_us(numbers[t.first + row * t.step], scale.offset); });
  });
  return result;
}

double to_double(const ColumnView& column, std::size_t row) {
  double result = 0.0;
  column.values->visit([&](auto numbers) { result = static_cast<double>(numbers[column.first + row * column.step]); });
  return result;
}

}  // namespace evbench::hdf5
