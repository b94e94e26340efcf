#pragma once

#include <map>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "core/data/track.hpp"

namespace evbench {

/// Of the observations that give a track's place at a time.
struct PlaceWindow {
  double length;  ///< [s], the time in its middle
  /// Where fewer than two are in it, the two nearest: of slow trackers, and in slow motion.
  bool or_nearest;

  PlaceWindow(double seconds, bool nearest = false) : length(seconds), or_nearest(nearest) {}
};

/// Track observations so far, by track. Every query is deterministic: tracks come in the order of their ids,
/// a track's observations in the order of their times.
class TrackBuffer {
 public:
  /// Adds observations in any order; those of a removed track, and those that are not finite, are ignored.
  void add(std::span<const TrackObservation> observations);

  /// Observations of a track in time order; empty for an unknown or removed track. Valid until the next add or remove.
  std::span<const TrackObservation> observations(TrackId track) const;

  std::vector<TrackId> ids() const;  ///< ascending
  std::size_t size() const { return tracks_.size(); }
  bool empty() const { return tracks_.empty(); }

  /// Tracks whose span of time, widened by `margin` [s] at both ends, contains t.
  std::vector<TrackId> alive(double t, double margin = 0.0) const;

  /// Where a track is at time t [px]: a robust straight line through its observations in the window, read at t; this
  /// averages quantisation and noise without the lag of a mean. The two nearest, where they are asked for, are none
  /// farther than 1 s, and none between which more than four times as much time passes as between those around them.
  /// The line needs observations that bracket t, or end no farther from it than a quarter of the window, or the time
  /// between those two; a single observation at t itself will do. None where the track doesn't cover t.
  std::optional<Vector2> position(TrackId track, double t, const PlaceWindow& window) const;

  /// Removes a track (an outlier); whatever comes of it later is ignored.
  void remove(TrackId track);

  /// Drops a track's observations; later ones are kept again.
  void forget(TrackId track) { tracks_.erase(track); }

  /// The same for all tracks whose last observation is older than t.
  void forget_ended_before(double t);

  bool removed(TrackId track) const { return removed_.contains(track); }

 private:
  std::map<TrackId, std::vector<TrackObservation>> tracks_;
  std::set<TrackId> removed_;
};

}  // namespace evbench
