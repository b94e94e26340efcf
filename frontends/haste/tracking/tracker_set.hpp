#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "frontends/haste/tracking/tracker.hpp"

namespace evbench::haste {

/// Trackers on a sensor, and which of them an event reaches: a grid over the sensor knows for each of its cells the
/// trackers whose range touches it, so that the others cost nothing. What comes out does not depend on how events are
/// cut into calls, nor a tracker's changes on what other trackers there are; sets in different threads share nothing.
class TrackerSet {
 public:
  TrackerSet(int width, int height);  ///< of the sensor [px]

  /// Ids count up from 0 and are not used again.
  std::int64_t add(Tracker tracker);
  void remove(std::int64_t id);
  bool contains(std::int64_t id) const { return slots_by_id_.contains(id); }
  /// Throws std::out_of_range for one that is not there.
  const Tracker& tracker(std::int64_t id) const { return *slots_[slots_by_id_.at(id)].tracker; }
  void move_by(std::int64_t id, const Vector2& translation, double angle);
  std::size_t size() const { return slots_by_id_.size(); }
  std::vector<std::int64_t> ids() const;  ///< ascending

  /// Hands events, in time order, to the trackers in whose range they are; those outside the sensor reach none. Appends
  /// the starts and changes of state in the order in which they happened; at one event by the trackers' slots.
  void push(std::span<const Event> events, std::vector<Change>& changes);

 private:
  struct Slot {
    std::unique_ptr<Tracker> tracker;  ///< none: the slot is free
    std::int64_t id = -1;
  };
  struct Centre {
    int x = 0, y = 0;
  };

  void enter(std::size_t slot, const GridState& at);
  void leave(std::size_t slot);
  void push(const Event& event, std::size_t slot, std::vector<Change>& changes);
  template <class CellChange>
  void for_cells_around(const Centre& centre, CellChange change);
  void grow();

  static constexpr int kCellBits = 2;  ///< cells of 4 × 4 px
  int width_, height_, columns_, rows_;
  std::size_t words_ = 1;             ///< of 64 slots, a cell
  std::vector<std::uint64_t> cells_;  ///< columns × rows × words: a bit for each slot
  std::vector<Slot> slots_;
  std::vector<Centre> centres_;  ///< of the slots' trackers, as the cells know them
  std::unordered_map<std::int64_t, std::size_t> slots_by_id_;
  std::int64_t next_id_ = 0;
};

}  // namespace evbench::haste
