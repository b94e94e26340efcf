#pragma once

#include <string>

#include "core/features/detection.hpp"
#include "core/plugin/options.hpp"
#include "frontends/haste/tracking/tracker_options.hpp"

namespace evbench::haste {

/// When a tracker ends.
struct LifeOptions {
  double spread = 0.2;
  double curvature = 0.02;
  double border = 8.0;
  double starvation = 15.0;
  double crowding = 5.0;
  double recognition = 0.45;
  bool erratic = true;

  void declare(OptionSet& set);
};

/// How the back-end's feedback is used.
struct GuidanceOptions {
  bool outliers = true;
  bool veto = true;
  bool reacquire = true;
  double gate = 4.0;
  double veto_distance = 5.0;
  int search = 4;
  double similarity = 0.45;
  int displacement = 20;
  double recognition = 0.55;
  int probation = 4;
  double tolerance = 3.0;
  double memory = 30.0;
  bool degraded = true;

  void declare(OptionSet& set);
};

struct Options {
  TrackerOptions tracker;
  DetectionOptions detection;
  LifeOptions life;
  GuidanceOptions guidance;
  int tracks = 60;
  std::string seeds = {};
  int threads = 1;
  double sigma = 0.5;
  bool score_covariance = false;
  enum class Place { new_state, midpoint, refined } place = Place::refined;
  double delay = 0.03;

  void declare(OptionSet& set);
};

}  // namespace evbench::haste
