#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/plugin/frontend.hpp"

namespace evbench {

/// Plays known tracks, for front-ends whose tracks are recorded or simulated: each observation and each end once.
class TrackPlayer {
 public:
  TrackPlayer() = default;

  /// `observations` in time order must outlive the player. `ends` are track ends in any order; a track may continue
  /// after an end. A track without an end at or after its last observation ends with that observation. Ends before a
  /// track's first observation are ignored.
  explicit TrackPlayer(std::span<const TrackObservation> observations, std::vector<TrackEnd> ends = {});

  /// See FrontEnd::advance().
  bool advance(const FrontEnd::Horizon& horizon, TrackBatch& batch);

 private:
  std::span<const TrackObservation> observations_;
  std::vector<TrackEnd> ends_;  ///< in time order
  std::size_t next_ = 0, next_end_ = 0;
};

}  // namespace evbench
