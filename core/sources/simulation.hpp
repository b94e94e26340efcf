#pragma once

#include "core/sources/simulated_sequence.hpp"

namespace evbench {

/// A simulated sequence of feature tracks: points of a scene, as a tracker would see them.
class Simulation : public SimulatedSequence {
 public:
  struct Options : SimulatedSequence::Options {
    SceneOptions scene;

    void declare(OptionSet& set);
  };

  Simulation(const Options& options, const SourceContext& context);

  std::vector<std::string> remarks() const override;
};

}  // namespace evbench
