#pragma once

#include <map>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "core/data/track.hpp"

namespace evbench {

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

  /// Where a track is at time t [px]: a robust straight line through its observations within ± window/2 [s], read at t;
  /// this averages quantisation and noise without the lag of a mean. Where there are fewer than two, as of a slow
  /// tracker or in slow motion, the nearest ones within 1 s make up for it. The line needs observations that bracket t,
  /// or end no farther from it than window/4 or the usual time between them; a single observation at t itself will do.
  /// None where the track doesn't cover t.
  std::optional<Vector2> position(TrackId track, double t, double window) const;

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
