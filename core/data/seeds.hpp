#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/data/track.hpp"

namespace evbench {

/// Points at which a front-end starts its tracks, in place of those that it detects: the first observation of each
/// track of a file (read_tracks()). So front-ends can be compared on the same features.
class Seeds {
 public:
  /// Reads a file, its path relative to `folder`; an empty path: none. Throws InputError as read_tracks() does.
  Seeds(const std::string& path, const std::string& folder);

  bool given() const { return !seeds_.empty(); }

  /// An id above those of all seeds; 0 without seeds.
  TrackId next_id() const;

  /// The next seed's time [s]; infinite when there is none left.
  double next() const;

  /// The seeds up to time t [s] that were not taken yet, in time order; valid until the object ends.
  std::span<const TrackObservation> take(double t);

 private:
  std::vector<TrackObservation> seeds_;  ///< in time order
  std::size_t taken_ = 0;
};

}  // namespace evbench
