#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/data/time_unit.hpp"
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

struct TrackFileOptions {
  double sigma = 1.0;                     ///< given to every observation [px]
  std::string columns = {};               ///< their names in their order, e.g. "t x y - id"; empty: as in the file
  TimeUnit time_unit = TimeUnit::unsaid;  ///< of times whose column does not say it
};

struct TrackFile {
  std::vector<TrackObservation> observations;  ///< by time, then by id
  TrackFileReport report;
  std::string assumption;  ///< a sentence on columns and unit of time where they could be others; empty: usual
};

/// Reads feature tracks, an observation a line in columns between blanks, tabs, commas or semicolons: an integer id,
/// time, pixels. Columns are those asked for, those that a line of names or the comment before the first record names,
/// or `id t x y` (EKLT, the RPG's feature tracking; more are not read), or HASTE's `t x y theta id`: five, of which the
/// last one is an integer and the first one is not. Times are seconds unless the options, the column's name (t_us) or
/// their size tell another unit (usual_time_unit()). Lines may come in any order. Observations outside a sensor of
/// width × height pixels are counted. Throws InputError, naming file and line, for another number of columns, a value
/// that is not finite, an id that is not an integer, and a file without observations.
TrackFile read_tracks(const std::string& path, int width, int height, const TrackFileOptions& options = {});

/// Reads where tracks end, a line `id t` [s] each, in any order; a track may end more than once, as it may be found
/// again. Throws InputError, naming file and line, for anything else. A file may be empty.
std::vector<TrackEnd> read_track_ends(const std::string& path);

/// As read_tracks() and read_track_ends() read them, in the shortest digits that read back as the same numbers.
std::string format_tracks(std::span<const TrackObservation> observations);
std::string format_track_ends(std::span<const TrackEnd> ends);

}  // namespace evbench
