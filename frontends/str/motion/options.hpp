#pragma once

#include "core/plugin/options.hpp"
#include "frontends/str/batches.hpp"
#include "frontends/str/registration/registration.hpp"

namespace evbench::str {

struct MotionTracksOptions {
  BatchOptions batch;
  RegistrationOptions registration;
  double shortest_batch = 0.01;
  double shortest_fit = 0.2;
  double patience = 0.2;
  double spacing = 40.0;
  double sigma = 0.1;

  MotionTracksOptions() {
    batch.duration = 0.05;
    batch.motion = 5.0;
  }

  void declare(OptionSet& set);
};

}  // namespace evbench::str
