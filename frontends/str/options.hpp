#pragma once

#include <string>

#include "core/features/detection.hpp"
#include "core/plugin/options.hpp"
#include "frontends/str/batches.hpp"
#include "frontends/str/registration/registration.hpp"

namespace evbench::str {

/// How a track goes from batch to batch.
struct PatchOptions {
  double radius = 12.0;
  int queries = 100;
  double least_fit = 0.5;
  double anchor_fit = 0.6;
  double border = 4.0;
  double crowding = 5.0;

  void declare(OptionSet& set);
};

struct Options {
  BatchOptions batch;
  RegistrationOptions registration;
  PatchOptions patch;
  DetectionOptions detection;
  int tracks = 60;
  std::string seeds = {};
  double sigma = 0.5;
  double interval = 0.01;
  enum class Start { last, backend } start = Start::last;

  Options() {
    batch.duration = 0.1;
    batch.motion = 5.0;
    registration.model = MotionModel::planar_4;
    detection.border = 8.0;
  }

  void declare(OptionSet& set);
};

}  // namespace evbench::str
