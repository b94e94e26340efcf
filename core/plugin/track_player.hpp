#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/plugin/frontend.hpp"

namespace evbench {

/// For front-ends whose tracks are known beforehand: plays each observation and each end of a track once.
class TrackPlayer {
 public:
  TrackPlayer() = default;

  /// The observations in time order; they must outlive the player. `ends`: where tracks end, in any order, also those
  /// that go on later. A track of which none is at its last observation or after it ends with that; those before its
  /// first one are none.
  explicit TrackPlayer(std::span<const TrackObservation> observations, std::vector<TrackEnd> ends = {});

  /// As FrontEnd::advance().
  bool advance(const FrontEnd::Horizon& horizon, TrackBatch& batch);

 private:
  std::span<const TrackObservation> observations_;
  std::vector<TrackEnd> ends_;  ///< in time order
  std::size_t next_ = 0, next_end_ = 0;
};

}  // namespace evbench
