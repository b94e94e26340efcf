#pragma once

#include <cstdint>

#include "core/data/problem.hpp"

namespace evbench {

struct TrackProblemOptions {
  double duration = 30.0;                    ///< [s]
  double state_rate = 20.0;                  ///< control states a second
  int tracks = 60;                           ///< alive at any time
  double shortest = 0.5, longest = 2.0;      ///< life of a track [s], if it doesn't leave the image before
  double slowest = 50.0, fastest = 100.0;    ///< observations of a track a second
  double depth_near = 2.0, depth_far = 6.0;  ///< of a new landmark [m]
  double noise = 0.7;                        ///< [px]
  double again = 0.0;                        ///< chance that a new track observes a landmark of before
  std::uint64_t seed = 1;
};

/// A problem like those that EVBENCH_PROBLEMS names: a camera of 240 × 180 pixels on a smooth random motion, tracks
/// with irregular observations, landmarks guessed with 10 % of their depth and a weak prior, the first state held by
/// priors. The states' guesses are the truth: incremental runs predict theirs.
Problem make_track_problem(const TrackProblemOptions& options);

}  // namespace evbench
