#pragma once

#include <span>

#include "core/data/track.hpp"
#include "core/plugin/point_truth.hpp"
#include "core/support/json.hpp"

namespace evbench {

/// How well tracks follow points of the scene, as "tracks" in metrics.json. The true track is that of the point which
/// is seen where the track begins. A piece of a track goes from its beginning, or its re-association, to its end;
/// observations less than 10 ms after the last one that counts, and those of points that are hidden or outside the
/// image, do not count.
///
///   pieces           number
///   life_s           {median, p90} of the time from the first to the last observation of a piece
///   alive            {after_100ms, after_500ms, after_1s}: share of the pieces that begin early enough
///   error_px         {at_100ms, at_500ms, at_1s}: {median, p90}, of the first observation within 50 ms after that age
///   beyond_3px       share of the observations that are farther off than 3 px
///   drifting         share of the pieces whose last observation is
///   reassociated     {right, wrong}: number of re-associations within 3 px of the true track of the track's very first
///                    observation, and of others
///
/// Values are null where nothing counts. `observations` and `ends` in time order, raw pixels; `end`: of the data [s].
Json score_tracks(std::span<const TrackObservation> observations, std::span<const TrackEnd> ends,
                  const PointTruth& truth, double end);

}  // namespace evbench
