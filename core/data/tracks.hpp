#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/data/track.hpp"

namespace evbench {

/// What was found in a track file.
struct TrackFileReport {
  std::int64_t records = 0;             ///< lines with an observation
  std::int64_t tracks = 0;              ///< different ids
  std::int64_t unordered = 0;           ///< records earlier than one before them in the same track: sorted
  std::int64_t duplicates = 0;          ///< records with the id and time of an earlier one: dropped
  std::int64_t outside = 0;             ///< observations outside the image: kept
  std::int64_t single_observation = 0;  ///< tracks that have one observation only: kept
};

struct TrackFile {
  std::vector<TrackObservation> observations;  ///< by time, then by id
  TrackFileReport report;
};

/// Reads feature tracks, `id t x y` a line: an integer id, seconds, pixels. Lines may come in any order. Observations
/// outside a sensor of width × height pixels are counted. `sigma` [px] is given to every observation.
/// Throws InputError, naming file and line, for a wrong number of columns, a value that is not finite, an id that is
/// not an integer, and a file without observations.
TrackFile read_tracks(const std::string& path, int width, int height, double sigma = 1.0);

/// The shortest digits that read back as the same numbers.
std::string format_tracks(std::span<const TrackObservation> observations);

}  // namespace evbench
