#pragma once

#include <string>

#include "core/features/detection.hpp"
#include "core/plugin/options.hpp"
#include "frontends/poisson/patch.hpp"

namespace evbench::poisson {

struct TrackerOptions {
  double radius = 15.0;
  double memory = 300.0;
  Patch::Shares shares = {.any_direction = 1.0, .noise = 0.3, .polarity = true};
  double lag = 0.2;
  bool rotation = true, scale = true;
  double acceleration = 0.07;
  double independence = 0.3;
  double step = 0.5, interval = 1.0;

  void declare(OptionSet& set);
};

/// When a tracker ends.
struct LifeOptions {
  double deviation = 0.6;
  double border = 8.0;
  double starvation = 15.0;
  double crowding = 5.0;

  void declare(OptionSet& set);
};

struct Options {
  TrackerOptions tracker;
  DetectionOptions detection;
  LifeOptions life;
  int tracks = 60;
  int threads = 1;
  std::string seeds = {};
  int window = 150, recent = 60000;
  int settling = 4;
  double sigma = 0.3;
  bool covariance = true;
  bool neighbours = true;
  double delay = 0.03;
  bool outliers = true;

  void declare(OptionSet& set);
};

}  // namespace evbench::poisson
