#pragma once

#include <deque>

#include "core/plugin/frontend.hpp"

namespace evbench {

/// A queue that sorts the observations of a front-end by time. Front-ends that observe tracks with a delay add
/// observations out of time order; each waits until no earlier one can follow.
class DelayedTracks {
 public:
  explicit DelayedTracks(double from) : until_(from) {}

  /// Adds an observation of a time that has not been released yet.
  void add(const TrackObservation& z);
  /// Removes the waiting observations of a track after time `t`.
  void take_back(TrackId track, double t);
  /// Adds the end of a track; ends must be added in time order.
  void end(const TrackEnd& ended) { ended_.push_back(ended); }

  /// Are at least `count` observations of times up to `t` waiting?
  bool has(std::size_t count, double t) const { return waiting_.size() >= count && waiting_[count - 1].t <= t; }

  /// Replaces `batch` by the observations and ends up to time `t`. With `most` > 0, the batch ends earlier: at the time
  /// of the observation with which this number is reached.
  void release(double t, std::size_t most, TrackBatch& batch);

  bool empty() const { return waiting_.empty() && ended_.empty(); }

 private:
  std::deque<TrackObservation> waiting_;  ///< in time order
  std::deque<TrackEnd> ended_;            ///< likewise
  double until_;                          ///< [s] everything up to here has been released
};

}  // namespace evbench
