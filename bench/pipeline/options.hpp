#pragma once

#include <string>

#include "core/plugin/options.hpp"

namespace evbench {

/// How front-end and back-end are coupled: the key "pipeline" of a config. `declare` documents each option.
struct PipelineOptions {
  double interval = 0.01;
  int observations = 0;
  double latency = 0.02;
  std::string mode = "sequential";
  int queue = 4;
  double patience = 1.0;
  bool relocalise = true;
  double stationary_after = 0.1;

  void declare(OptionSet& set);
};

}  // namespace evbench
