#pragma once

#include <limits>
#include <span>
#include <string>
#include <vector>

#include "core/data/time_unit.hpp"
#include "core/data/track.hpp"

namespace evbench {

/// Statistics of a track file.
struct TrackFileReport {
  std::int64_t records = 0;             ///< lines with an observation
  std::int64_t tracks = 0;              ///< different ids
  std::int64_t unordered = 0;           ///< records earlier than a previous one of the same track: sorted
  std::int64_t duplicates = 0;          ///< records with the id and time of an earlier one: dropped
  std::int64_t outside = 0;             ///< observations outside the image: kept
  std::int64_t single_observation = 0;  ///< tracks that have one observation only: kept
};

struct TrackFileOptions {
  double sigma = 1.0;                     ///< given to every observation [px]
  std::string columns = {};               ///< names in their order, e.g. "t x y - id"; empty: as in the file
  TimeUnit time_unit = TimeUnit::unsaid;  ///< of times whose column does not give it
};

struct TrackFile {
  std::vector<TrackObservation> observations;  ///< by time, then by id
  TrackFileReport report;
  std::string assumption;  ///< a sentence if columns or unit of time were assumed; empty: usual layout
};

/// A sensor's width and height for read_tracks() where no image limits the tracks.
inline constexpr int kAnySize = std::numeric_limits<int>::max();

/// Reads feature tracks, one observation per line in columns separated by blanks, tabs, commas or semicolons: an
/// integer id, time, pixel. The columns are those of the options, those named by a line of names or the comment before
/// the first record, HASTE's `t x y theta id` (five columns, the last an integer and the first not), or `id t x y`
/// (EKLT, the RPG's feature tracking; further columns are not read). Times are seconds unless the options, the column
/// name (t_us) or their size give another unit (usual_time_unit()). Lines may be in any order. Observations outside a
/// sensor of width × height pixels are counted. Throws InputError with file and line for a wrong number of columns, a
/// value that is not finite, an id that is not an integer, and a file without observations.
TrackFile read_tracks(const std::string& path, int width, int height, const TrackFileOptions& options = {});

/// Reads track ends, one per line as `id t` [s], in any order. A track may end more than once, because it may continue
/// after re-association. Throws InputError with file and line for anything else. A file may be empty.
std::vector<TrackEnd> read_track_ends(const std::string& path);

/// Write the formats of read_tracks() and read_track_ends(), with the shortest digits that read back as the same
/// numbers.
std::string format_tracks(std::span<const TrackObservation> observations);
std::string format_track_ends(std::span<const TrackEnd> ends);

}  // namespace evbench
