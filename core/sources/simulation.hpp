#pragma once

#include "core/plugin/registry.hpp"
#include "core/simulation/motion.hpp"
#include "core/simulation/scene.hpp"
#include "core/simulation/track_simulator.hpp"
#include "core/sources/simulated_camera.hpp"

namespace evbench {

/// A simulated sequence from 0 to `duration`: motion, scene and feature tracks with known association, ground truth.
/// Equal options and seed give equal bytes.
class Simulation : public Source {
 public:
  struct Options {
    double duration = 30.0;
    std::int64_t seed = -1;
    double ground_truth_rate = 200.0;
    SimulatedCameraOptions camera;
    MotionOptions motion;
    SceneOptions scene;
    TrackOptions tracks;

    void declare(OptionSet& set);
  };

  Simulation(const Options& options, const SourceContext& context);

  const Camera& camera() const override { return camera_; }
  TimeRange time_range() const override { return {0.0, duration_}; }
  const PoseTrajectory& ground_truth() const override { return ground_truth_; }
  std::optional<std::span<const TrackObservation>> true_tracks() const override { return tracks_.observations; }
  std::vector<std::string> files() const override { return files_; }
  std::vector<std::string> remarks() const override;

  const SimulatedTracks& tracks() const { return tracks_; }

 private:
  double duration_;
  Camera camera_;
  PoseTrajectory ground_truth_;
  SimulatedTracks tracks_;
  std::vector<std::string> files_;
};

}  // namespace evbench
