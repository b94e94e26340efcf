#pragma once

#include <memory>
#include <mutex>
#include <string>

#include "core/simulation/events/event_simulator.hpp"
#include "core/simulation/events/scene_brightness.hpp"
#include "core/simulation/events/scene_truth.hpp"
#include "core/sources/simulated_sequence.hpp"

namespace evbench {

/// A simulated recording of an event camera. The events are simulated while they are read; the tracks are those of the
/// scene's features.
class EventSimulation : public SimulatedSequence {
 public:
  struct Options : SimulatedSequence::Options {
    RenderedSceneOptions scene;
    RenderingOptions rendering;
    SimulatorOptions simulator;
    std::string cache = {};

    Options() { duration = 10.0; }
    void declare(OptionSet& set);
  };

  EventSimulation(const Options& options, const SourceContext& context);

  std::unique_ptr<EventReader> all_events() const override;
  bool silence_is_known() const override { return true; }
  std::vector<std::string> remarks() const override;
  std::shared_ptr<const PointTruth> point_truth() const override { return std::make_shared<SceneTruth>(truth()); }

  /// Depth at any pixel and time, and the true track of any point.
  SceneTruth truth() const { return {camera(), drawn_scene(), motion()}; }
  const RenderedScene& scene() const { return *drawn_scene(); }

 private:
  /// Made on first use: it takes time, and neither planning a sweep nor reading recorded events needs it.
  std::shared_ptr<const RenderedScene> drawn_scene() const;
  std::unique_ptr<EventReader> simulated_events() const;
  std::string cache_file(const Options& options) const;

  RenderedSceneOptions scene_options_;
  std::string folder_, place_;  ///< folder of the picture; place in messages
  std::string cache_;           ///< file that keeps the events; empty: none does
  RenderingOptions rendering_;
  SimulatorOptions simulator_;
  mutable std::once_flag drawn_;
  mutable std::shared_ptr<const RenderedScene> scene_;
};

}  // namespace evbench
