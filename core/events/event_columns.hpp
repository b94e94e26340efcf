#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/data/time_unit.hpp"

namespace evbench {

/// What a column of a table of events holds.
enum class EventColumn : std::uint8_t { t, x, y, p, other };

using EventOrder = std::vector<EventColumn>;

/// "t x y p -".
std::string to_string(const EventOrder& order);

/// What names say of a table of events.
struct EventColumns {
  EventOrder order;
  TimeUnit unit = TimeUnit::unsaid;
};

/// By their names in their order, e.g. "x,y,p,t_us". False, and nothing is changed, unless time, x, y and polarity are
/// among them, each once.
bool read_event_columns(std::string_view names, EventColumns& columns);

/// Throws InputError where that is false.
EventColumns named_event_columns(std::string_view names, const std::string& place);

/// An event as numbers whose meaning is looked for.
struct EventRow {
  std::vector<double> values;
  std::vector<bool> have_fractions;  ///< or are written with a decimal point or an exponent
};

/// The one of the orders that most rows fit, but for one in twenty; times do not decrease, unless nothing fits then.
/// Throws InputError, which asks for --columns, where none or several fit. `rows`: at least one.
EventOrder find_event_order(std::span<const EventRow> rows, std::span<const EventOrder> orders,
                            const std::string& place);

}  // namespace evbench
