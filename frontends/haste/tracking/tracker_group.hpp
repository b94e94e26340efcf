#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "frontends/haste/tracking/tracker.hpp"

namespace evbench::haste {

/// The trackers on a sensor that one thread updates. A grid over the sensor holds for each of its cells the trackers
/// that are near, so that an event costs nothing for the others. Events are processed in batches of some thousand: they
/// are first sorted by tracker and then passed to one tracker after the other, which so stays in the processor's cache.
/// A tracker that moves farther in a batch than the grid allows for checks all remaining events. A tracker's changes do
/// not depend on the other trackers.
class TrackerGroup {
 public:
  /// A start or a change of state.
  struct Found {
    std::size_t event;  ///< index of the pushed event that led to it
    Change change;
  };

  TrackerGroup(int width, int height);  ///< of the sensor [px]

  /// Returns the tracker's slot, which may be reused once it is removed. Its changes are reported under `id`.
  std::size_t add(std::int64_t id, Tracker tracker);
  void remove(std::size_t slot);
  const Tracker& tracker(std::size_t slot) const { return *slots_[slot].tracker; }
  std::size_t size() const { return size_; }

  /// Passes events, in time order, to the trackers in whose range they are; those outside the sensor reach none.
  /// Nothing is allocated once the buffers have reached their largest size.
  void push(std::span<const Event> events);
  /// The changes of the last push, in no particular order.
  const std::vector<Found>& found() const { return found_; }

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

  void sort_by_trackers(std::span<const Event> batch);
  void track(std::size_t slot, std::span<const Event> batch, std::size_t first);
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
  std::size_t size_ = 0;
  std::vector<Found> found_;
};

}  // namespace evbench::haste
