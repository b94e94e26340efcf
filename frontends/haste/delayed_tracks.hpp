#pragma once

#include <deque>

#include "core/plugin/frontend.hpp"

namespace evbench::haste {

/// Observations on their way to the back-end: they come out of time order, and wait until none before them can come.
class DelayedTracks {
 public:
  explicit DelayedTracks(double from) : until_(from) {}

  /// An observation of a time that has been told already counts as of now.
  void add(TrackObservation z);
  void end(const TrackEnd& ended) { ended_.push_back(ended); }

  /// Whether so many observations stand for times up to `t`.
  bool has(std::size_t count, double t) const { return waiting_.size() >= count && waiting_[count - 1].t <= t; }

  /// What stands for times up to `t`; with `most` above 0 not beyond the time of so many observations.
  void tell(double t, std::size_t most, TrackBatch& batch);

  double until() const { return until_; }  ///< [s] what was told stands for times up to here
  bool empty() const { return waiting_.empty() && ended_.empty(); }
  std::size_t late() const { return late_; }  ///< observations that came too late

 private:
  std::deque<TrackObservation> waiting_;  ///< in time order
  std::deque<TrackEnd> ended_;            ///< likewise
  double until_;
  std::size_t late_ = 0;
};

}  // namespace evbench::haste
