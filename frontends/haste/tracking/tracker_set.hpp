#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "frontends/haste/tracking/tracker_group.hpp"

namespace evbench::haste {

/// Trackers on a sensor, in groups that share nothing, so that a thread can update each group. The results depend
/// neither on the number of groups nor on how events are divided into calls.
class TrackerSet {
 public:
  /// `width`, `height`: of the sensor [px]. `threads`: 0: one a processor, which is also the most.
  TrackerSet(int width, int height, int threads = 1);

  /// Ids count up from 0 and are not used again.
  std::int64_t add(Tracker tracker);
  void remove(std::int64_t id);
  /// Throws std::out_of_range for one that is not there.
  const Tracker& tracker(std::int64_t id) const;
  std::size_t size() const { return places_.size(); }
  std::vector<std::int64_t> ids() const;  ///< ascending

  /// Passes events, in time order, to the trackers in whose range they are; those outside the sensor reach none.
  /// Appends the starts and changes of state in the order in which they happen; those of one event in the order of ids.
  /// With one thread nothing is allocated once the buffers have reached their largest size and `changes` has room.
  void push(std::span<const Event> events, std::vector<Change>& changes);

 private:
  struct Place {
    std::size_t group, slot;
  };

  std::vector<TrackerGroup> groups_;
  std::map<std::int64_t, Place> places_;
  std::int64_t next_id_ = 0;
  std::vector<TrackerGroup::Found> found_;  ///< by all groups
};

}  // namespace evbench::haste
