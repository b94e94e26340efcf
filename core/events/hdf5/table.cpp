#include "core/events/hdf5/table.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/support/error.hpp"
#include "core/support/index.hpp"

namespace evbench::hdf5 {

EventTable::EventTable(const File& file, const EventLayout& layout, const EventOrder& asked) {
  if (layout.is_rows()) {
    all_ = file.dataset(layout.group);
    order_ = find_order(layout, all_, asked);
    length_ = all_.rows();
    return;
  }
  x_ = file.dataset(layout.x);
  y_ = file.dataset(layout.y);
  t_ = file.dataset(layout.t);
  p_ = file.dataset(layout.p);
  length_ = std::min({x_.rows(), y_.rows(), t_.rows(), p_.rows()});
  for (const Dataset* column : {&x_, &y_, &t_, &p_}) {
    if (column->shape().empty() || column->columns() != 1) {
      throw InputError(fmt::format("{}: /{}: has a column that is {}; expected one number a row", file.path(),
                                   layout.group, column->describe()));
    }
    surplus_ = std::max(surplus_, column->rows() - length_);
  }
}

void EventTable::read(std::uint64_t begin, std::uint64_t end, Piece& piece) const {
  read_times_and_polarities(begin, end, piece);
  if (!order_.empty()) return;
  piece.end = begin;  // nothing, should this fail
  x_.read(begin, end - begin, piece.x);
  y_.read(begin, end - begin, piece.y);
  piece.end = end;
}

void EventTable::read_times_and_polarities(std::uint64_t begin, std::uint64_t end, Piece& piece) const {
  piece.begin = piece.end = begin;
  if (order_.empty()) {
    t_.read(begin, end - begin, piece.t);
    p_.read(begin, end - begin, piece.p);
  } else {
    all_.read(begin, end - begin, piece.all);
  }
  piece.end = end;
}

ColumnView EventTable::view(const Values& own, const Values& all, EventColumn column, std::size_t first) const {
  if (order_.empty()) return {&own, first, 1};
  const std::size_t place = index(std::ranges::find(order_, column) - order_.begin());
  return {&all, order_.size() * first + place, order_.size()};
}

ColumnViews EventTable::views(const Piece& piece, std::uint64_t row) const {
  const std::size_t first = row - piece.begin;
  return {view(piece.x, piece.all, EventColumn::x, first), view(piece.y, piece.all, EventColumn::y, first),
          view(piece.t, piece.all, EventColumn::t, first), view(piece.p, piece.all, EventColumn::p, first)};
}

std::int64_t EventTable::time(std::uint64_t row, const TimeScale& scale) const {
  Values values;
  times().read(row, 1, values);
  return to_time(view(values, values, EventColumn::t, 0), 0, scale);
}

}  // namespace evbench::hdf5
