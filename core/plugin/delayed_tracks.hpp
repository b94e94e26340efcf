#pragma once

#include <deque>

#include "core/plugin/frontend.hpp"

namespace evbench {

/// Observations on their way to the back-end: they come out of time order, and wait until none before them can come.
class DelayedTracks {
 public:
  explicit DelayedTracks(double from) : until_(from) {}

  /// One of a time that has not been told yet.
  void add(const TrackObservation& z);
  /// Leaves out those of a track that stand for times after `t` and have not been told yet.
  void take_back(TrackId track, double t);
  /// Ends come in time order.
  void end(const TrackEnd& ended) { ended_.push_back(ended); }

  /// Whether so many observations stand for times up to `t`.
  bool has(std::size_t count, double t) const { return waiting_.size() >= count && waiting_[count - 1].t <= t; }

  /// What stands for times up to `t`; with `most` above 0 not beyond the time of so many observations.
  void tell(double t, std::size_t most, TrackBatch& batch);

  bool empty() const { return waiting_.empty() && ended_.empty(); }

 private:
  std::deque<TrackObservation> waiting_;  ///< in time order
  std::deque<TrackEnd> ended_;            ///< likewise
  double until_;                          ///< [s] what was told stands for times up to here
};

}  // namespace evbench
