#pragma once

#include <memory>
#include <mutex>
#include <string>

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
  bool silence_is_known() const override { return true; }
  std::vector<std::string> remarks() const override;

  /// Depth at any pixel and time, and the true track of any point.
  SceneTruth truth() const { return {camera(), drawn_scene(), motion()}; }
  const RenderedScene& scene() const { return *drawn_scene(); }

 private:
  /// Drawn when it is needed first: that takes its time, and who plans a sweep, or reads events that were recorded, has
  /// no use for it.
  std::shared_ptr<const RenderedScene> drawn_scene() const;

  RenderedSceneOptions look_;
  std::string folder_, place_;  ///< of its picture; for messages
  RenderingOptions rendering_;
  SimulatorOptions simulator_;
  mutable std::once_flag drawn_;
  mutable std::shared_ptr<const RenderedScene> scene_;
};

}  // namespace evbench
