#pragma once

#include <memory>

#include "core/simulation/events/event_simulator.hpp"
#include "core/simulation/events/scene_brightness.hpp"
#include "core/simulation/events/scene_truth.hpp"
#include "core/sources/simulated_sequence.hpp"

namespace evbench {

/// A simulated recording of an event camera: events, made while they are read; the tracks are those of the scene's
/// features.
class EventSimulation : public SimulatedSequence {
 public:
  struct Options : SimulatedSequence::Options {
    RenderedSceneOptions scene;
    RenderingOptions rendering;
    SimulatorOptions simulator;

    Options() { duration = 10.0; }
    void declare(OptionSet& set);
  };

  EventSimulation(const Options& options, const SourceContext& context);

  std::unique_ptr<EventReader> all_events() const override;
  std::vector<std::string> remarks() const override;

  /// Depth at any pixel and time, and the true track of any point.
  SceneTruth truth() const { return {camera(), scene_, motion()}; }
  const RenderedScene& scene() const { return *scene_; }

 private:
  RenderingOptions rendering_;
  SimulatorOptions simulator_;
  std::shared_ptr<const RenderedScene> scene_;
};

}  // namespace evbench
