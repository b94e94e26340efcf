#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "frontends/haste/tracking/tracker.hpp"

namespace evbench::haste {

/// Trackers on a sensor, and which of them an event reaches: a grid over the sensor knows for each of its cells the
/// trackers that are near, so that the others cost nothing. Events are taken some thousand at a time, first sorted by
/// trackers and then handed to one tracker after the other, which so stays in the processor's cache; a tracker that in
/// the meantime has gone farther than the grid allows for looks at all the rest. What comes out does not depend on how
/// events are cut into calls, nor a tracker's changes on what other trackers there are; sets in different threads share
/// nothing. No allocation once the set has been as busy as it gets.
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
  /// the starts and changes of state in the order in which they happened; those of one event in the order of ids.
  void push(std::span<const Event> events, std::vector<Change>& changes);

 private:
  struct Centre {
    int x = 0, y = 0;
  };
  struct Slot {
    std::unique_ptr<Tracker> tracker;  ///< none: the slot is free
    std::int64_t id = -1;
    std::vector<std::uint16_t> near;  ///< the batch's events that may be in range: the first near_count
    std::size_t near_count = 0;
  };
  struct Found {
    std::size_t event;  ///< its place in the batch
    Change change;
  };

  void push_batch(std::span<const Event> events, std::vector<Change>& changes);
  void sort_by_trackers(std::span<const Event> events);
  void track(std::size_t slot, std::span<const Event> events);
  void enter(std::size_t slot);
  void leave(std::size_t slot);
  template <class CellChange>
  void for_cells_around(const Centre& centre, CellChange change);
  void grow();

  int width_, height_, columns_, rows_;
  std::size_t words_ = 1;             ///< of 64 slots, a cell
  std::vector<std::uint64_t> cells_;  ///< columns × rows × words: a bit for each slot
  std::vector<Slot> slots_;
  std::vector<Centre> centres_;  ///< of the slots' trackers, as the cells know them
  std::unordered_map<std::int64_t, std::size_t> slots_by_id_;
  std::int64_t next_id_ = 0;
  std::vector<Found> found_;  ///< in the batch
};

}  // namespace evbench::haste
