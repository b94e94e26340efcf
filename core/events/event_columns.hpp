#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/data/time_unit.hpp"

namespace evbench {

/// Content of a column of a table of events.
enum class EventColumn : std::uint8_t { t, x, y, p, other };

using EventOrder = std::vector<EventColumn>;

/// "t x y p -".
std::string to_string(const EventOrder& order);

/// Order and time unit of a table's columns, according to their names.
struct EventColumns {
  EventOrder order;
  TimeUnit unit = TimeUnit::unsaid;
};

/// Reads the columns' names in their order, e.g. "x,y,p,t_us". Returns false and changes nothing unless time, x, y and
/// polarity are each named once.
bool read_event_columns(std::string_view names, EventColumns& columns);

/// The same, but throws InputError in place of returning false.
EventColumns named_event_columns(std::string_view names, const std::string& place);

/// An event as numbers whose meaning is unknown.
struct EventRow {
  std::vector<double> values;
  std::vector<bool> have_fractions;  ///< fraction, decimal point or exponent
};

/// The one of the orders that at least 19 of 20 rows fit, with times that do not decrease; only if none fits, times may
/// decrease. Throws InputError, which names --columns as the remedy, when none or several fit. `rows`: at least one.
EventOrder find_event_order(std::span<const EventRow> rows, std::span<const EventOrder> orders,
                            const std::string& place);

}  // namespace evbench
