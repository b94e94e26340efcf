#pragma once

#include <memory>

#include "core/plugin/registry.hpp"
#include "core/simulation/events/event_simulator.hpp"
#include "core/simulation/events/scene_brightness.hpp"
#include "core/simulation/events/scene_truth.hpp"
#include "core/simulation/track_simulator.hpp"
#include "core/sources/simulated_camera.hpp"

namespace evbench {

/// A simulated recording of an event camera from 0 to `duration`: events, made while they are read; the true motion;
/// tracks of the scene's features with known association. Equal options and seed give equal bytes.
class EventSimulation : public Source {
 public:
  struct Options {
    double duration = 10.0;
    std::int64_t seed = -1;
    double ground_truth_rate = 200.0;
    SimulatedCameraOptions camera;
    MotionOptions motion;
    RenderedSceneOptions scene;
    RenderingOptions rendering;
    SimulatorOptions simulator;
    TrackOptions tracks;

    void declare(OptionSet& set);
  };

  EventSimulation(const Options& options, const SourceContext& context);

  const Camera& camera() const override { return camera_; }
  TimeRange time_range() const override { return {0.0, options_.duration}; }
  const PoseTrajectory& ground_truth() const override { return ground_truth_; }
  std::unique_ptr<EventReader> events() const override;
  std::optional<std::span<const TrackObservation>> true_tracks() const override { return tracks_.observations; }
  std::vector<std::string> files() const override { return files_; }
  std::vector<std::string> remarks() const override;

  /// Depth at any pixel and time, and the true track of any point.
  SceneTruth truth() const { return {camera_, scene_, motion_}; }
  const RenderedScene& scene() const { return *scene_; }
  const SimulatedTracks& tracks() const { return tracks_; }

 private:
  Options options_;
  Camera camera_;
  std::uint64_t sensor_seed_ = 0;
  Motion motion_;
  std::shared_ptr<const RenderedScene> scene_;
  PoseTrajectory ground_truth_;
  SimulatedTracks tracks_;
  std::vector<std::string> files_;
};

}  // namespace evbench
