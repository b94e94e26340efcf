#include "core/events/event_columns.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/data/columns.hpp"
#include "core/support/error.hpp"
#include "core/support/index.hpp"

namespace evbench {
namespace {

constexpr Quantity kEventQuantities[] = {kTime, {"x", "x.*"}, {"y", "y.*"}, {"p", "p.*|on"}};

/// No file has fractions in its pixels and none in its times.
bool fits(const EventRow& row, const EventOrder& order, std::size_t time) {
  constexpr double kMostPixels = 65535.0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const double value = row.values[i];
    const bool is_pixel = value >= 0.0 && value <= kMostPixels && value == std::floor(value) &&
                          (!row.have_fractions[i] || row.have_fractions[time]);
    if ((order[i] == EventColumn::x || order[i] == EventColumn::y) && !is_pixel) return false;
    constexpr double kMinusOnes[] = {-1.0, 255.0, 65535.0, 4294967295.0};  // stored with a sign or without
    const bool is_polarity =
        value == 0.0 || value == 1.0 || std::ranges::find(kMinusOnes, value) != std::end(kMinusOnes);
    if (order[i] == EventColumn::p && !is_polarity) return false;
  }
  return true;
}

std::int64_t count_fitting(std::span<const EventRow> rows, const EventOrder& order, bool in_time_order) {
  const std::size_t time = index(std::ranges::find(order, EventColumn::t) - order.begin());
  double last = rows.front().values[time];
  return std::ranges::count_if(rows, [&](const EventRow& row) {
    const double t = row.values[time], before = std::exchange(last, t);
    // Times may be out of order only if they have fractions, which pixels cannot have.
    return fits(row, order, time) && (in_time_order ? t >= before : bool(row.have_fractions[time]));
  });
}

}  // namespace

std::string to_string(const EventOrder& order) {
  constexpr const char* kNames[] = {"t", "x", "y", "p", "-"};
  std::vector<std::string> names;
  for (const EventColumn column : order) names.emplace_back(kNames[index(column)]);
  return fmt::to_string(fmt::join(names, " "));
}

bool read_event_columns(std::string_view names, EventColumns& columns) {
  const Columns found(names, kEventQuantities);
  if (!found.ambiguity().empty() || found.nanoseconds()) return false;
  EventOrder order(found.size(), EventColumn::other);
  constexpr EventColumn kColumns[] = {EventColumn::t, EventColumn::x, EventColumn::y, EventColumn::p};
  for (std::size_t i = 0; i < std::size(kEventQuantities); ++i) {
    const auto column = found.find(kEventQuantities[i].name);
    if (!column) return false;
    order[*column] = kColumns[i];
  }
  columns = {std::move(order), found.time_unit()};
  return true;
}

EventColumns named_event_columns(std::string_view names, const std::string& place) {
  EventColumns columns;
  if (read_event_columns(names, columns)) return columns;
  const Columns found(names, kEventQuantities);
  if (!found.ambiguity().empty()) {
    throw InputError(fmt::format(
        "{}: the columns are named {}; give --columns (source.columns in a run's config), with - for one of them",
        place, found.ambiguity()));
  }
  throw InputError(fmt::format("{}: names the columns \"{:.80}\"; expected time, x, y and polarity{}", place, names,
                               found.nanoseconds() ? ", the time in one column" : ""));
}

EventOrder find_event_order(std::span<const EventRow> rows, std::span<const EventOrder> orders,
                            const std::string& place) {
  std::vector<std::string> possible;
  for (const bool in_time_order : {true, false}) {
    std::vector<std::int64_t> counts;
    for (const EventOrder& order : orders) counts.push_back(count_fitting(rows, order, in_time_order));
    const std::int64_t most = std::ranges::max(counts);
    if (most == 0) continue;
    if (std::ranges::count(counts, most) == 1) {
      if (20 * most >= 19 * std::ssize(rows)) return orders[index(std::ranges::find(counts, most) - counts.begin())];
      continue;
    }
    for (std::size_t i = 0; i < orders.size() && possible.size() < 2; ++i) {
      if (counts[i] == most) possible.push_back(to_string(orders[i]));
    }
  }
  std::vector<std::string> all;
  for (const EventOrder& order : orders) all.push_back(to_string(order));
  throw InputError(fmt::format("{}: has lines like \"{}\", which {}; give --columns (source.columns in a run's config)",
                               place, fmt::to_string(fmt::join(rows.front().values, " ")),
                               possible.empty()
                                   ? fmt::format("are neither \"{}\"", fmt::to_string(fmt::join(all, "\" nor \"")))
                                   : fmt::format("may be \"{}\"", fmt::to_string(fmt::join(possible, "\" and \"")))));
}

}  // namespace evbench
