#pragma once

#include <memory>
#include <string>
#include <vector>

#include "backends/gp_map/gp_map.hpp"
#include "core/plugin/track_player.hpp"
#include "core/plugin/undistort.hpp"
#include "core/simulation/track_simulator.hpp"
#include "core/support/index.hpp"
#include "eval/scores.hpp"

namespace evbench::gp_map::testing {

/// A camera of 240 × 180 pixels that moves in front of a volume of points, with simulated tracks.
class TrackedScene {
 public:
  /// `options`: {"motion": {...}, "scene": {...}, "tracks": {...}}; they override the defaults here.
  explicit TrackedScene(double duration, const char* options = "{}", std::uint64_t seed = 1);

  PinholeCamera camera() const { return camera_.pinhole; }
  double duration() const { return duration_; }
  const PoseTrajectory& ground_truth() const { return ground_truth_; }
  const std::vector<UndistortedObservation>& observations() const { return observations_; }
  /// Plays the tracks as a front-end does.
  TrackPlayer player() const { return TrackPlayer(tracks_.observations); }
  UndistortedBatch undistorted(const TrackBatch& batch) const { return undistort(batch, camera_); }
  const Vector3& point(TrackId track) const { return tracks_.tracks[index(track)].point; }

 private:
  double duration_;
  Camera camera_;
  PoseTrajectory ground_truth_;
  SimulatedTracks tracks_;
  std::vector<UndistortedObservation> observations_;
};

struct RunOptions {
  const char* backend = "{}";
  double chunk = 0.01;  ///< [s]
};

struct Run {
  std::unique_ptr<GpMap> backend;
  PoseTrajectory causal;
  Scores scores;  ///< of the final trajectory at 100 Hz; empty if there is none
};

Run run(const TrackedScene& scene, const RunOptions& options = {});

}  // namespace evbench::gp_map::testing
