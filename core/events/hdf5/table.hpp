#pragma once

#include <cstdint>

#include "core/events/event_columns.hpp"
#include "core/events/hdf5/columns.hpp"
#include "core/events/hdf5/file.hpp"
#include "core/events/hdf5/layout.hpp"

namespace evbench::hdf5 {

/// A file's events as numbers: in separate columns, or in rows. Moved, not copied.
class EventTable {
 public:
  /// `asked`: the order of rows, as in find_order(). Throws InputError for other shapes.
  EventTable(const File& file, const EventLayout& layout, const EventOrder& asked);

  std::uint64_t rows() const { return length_; }      ///< of the shortest column
  std::uint64_t surplus() const { return surplus_; }  ///< additional rows of the longest
  const EventOrder& order() const { return order_; }  ///< of rows; empty: separate columns
  const Dataset& times() const { return order_.empty() ? t_ : all_; }

  /// Rows from `begin` to `end`.
  struct Piece {
    Values x, y, t, p, all;
    std::uint64_t begin = 0, end = 0;
  };
  void read(std::uint64_t begin, std::uint64_t end, Piece& piece) const;
  /// Of separate columns only these two.
  void read_times_and_polarities(std::uint64_t begin, std::uint64_t end, Piece& piece) const;
  /// From a row of the piece on.
  ColumnViews views(const Piece& piece, std::uint64_t row) const;

  std::int64_t time(std::uint64_t row, const TimeScale& scale) const;  ///< [µs], or kBroken

 private:
  ColumnView view(const Values& own, const Values& all, EventColumn column, std::size_t first) const;

  Dataset x_, y_, t_, p_, all_;
  EventOrder order_;
  std::uint64_t length_ = 0, surplus_ = 0;
};

}  // namespace evbench::hdf5
