#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/data/track.hpp"

namespace evbench {

/// How tracks are compared with true ones that have the same ids. The relative age of a track is the share of the true
/// track's time until its first error beyond a threshold, 0 if that is at once.
/// - full: a track that ends before its true one has failed there, and a true track without a track has age 0.
/// - cropped: the true track is cut to the track's time first, true tracks without a track do not count, and the age
///   ends one true observation earlier, as in the public evaluation of Messikommer et al. (CVPR 2023). A track that
///   stops early and accurately has age 1.
enum class TrackProtocol { full, cropped };

/// The metrics by which trackers on events are compared, over thresholds of 1, 2, ..., 31 px.
struct TrackBenchmark {
  std::size_t tracks = 0;   ///< that count
  double expected_age = 0;  ///< mean over thresholds of inlier ratio × age: expected feature age
  double inlier_ratio = 0;  ///< mean over thresholds of the share of tracks whose age is not 0
  double age = 0;           ///< mean over thresholds of the mean age of tracks whose age is not 0
  double age_5px = 0;       ///< the same at 5 px
  double error_5px = 0;     ///< mean over these tracks of the mean error until their age ends [px]
};

/// Errors are taken at the times of the true observations but the first, from the straight lines between a track's
/// observations (before and behind them: the first and the last line goes on). Both in time order. Tracks without a
/// true one, and true tracks of one observation, do not count. Throws InputError if no track does.
TrackBenchmark benchmark_tracks(std::span<const TrackObservation> truth, std::span<const TrackObservation> tracks,
                                TrackProtocol protocol);

}  // namespace evbench
