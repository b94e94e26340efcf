#pragma once

#include <map>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "core/data/track.hpp"

namespace evbench {

/// Selects the observations that give a track's position at a time.
struct PlaceWindow {
  double length;  ///< [s], centred at the time
  /// If fewer than two are within, use the two nearest: for slow trackers and slow motion.
  bool or_nearest;

  PlaceWindow(double seconds, bool nearest = false) : length(seconds), or_nearest(nearest) {}
};

/// All track observations so far, by track. Queries are deterministic: tracks are in the order of their ids,
/// observations of a track in time order.
class TrackBuffer {
 public:
  /// Adds observations in any order; those of a removed track, and those that are not finite, are ignored.
  void add(std::span<const UndistortedObservation> observations);

  /// Observations of a track in time order; empty for an unknown or removed track. Valid until the next add or remove.
  std::span<const UndistortedObservation> observations(TrackId track) const;

  std::vector<TrackId> ids() const;  ///< ascending
  std::size_t size() const { return tracks_.size(); }
  bool empty() const { return tracks_.empty(); }

  /// Tracks whose span of time, widened by `margin` [s] at both ends, contains t.
  std::vector<TrackId> alive(double t, double margin = 0.0) const;

  /// Position of a track at time t [px]: a robust straight line through its observations in the window, evaluated at t.
  /// It averages quantisation and noise without the lag of a mean. The two nearest observations (or_nearest) are used
  /// only within 1 s of t, and only if the gap between them is at most four times those around them. The observations
  /// must bracket t or come within a quarter of the window of it (or within the gap of the two nearest); a single
  /// observation at t suffices. None if the track doesn't cover t.
  std::optional<Vector2> position(TrackId track, double t, const PlaceWindow& window) const;

  /// Removes a track (an outlier); its later observations are ignored.
  void remove(TrackId track);

  /// Drops a track's observations; later ones are kept again.
  void forget(TrackId track) { tracks_.erase(track); }

  /// The same for all tracks whose last observation is older than t.
  void forget_ended_before(double t);

  bool removed(TrackId track) const { return removed_.contains(track); }

 private:
  std::map<TrackId, std::vector<UndistortedObservation>> tracks_;
  std::set<TrackId> removed_;
};

}  // namespace evbench
