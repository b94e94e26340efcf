#pragma once

#include "core/plugin/options.hpp"
#include "frontends/str/batches.hpp"
#include "frontends/str/dots/dot.hpp"
#include "frontends/str/dots/segmentation.hpp"
#include "frontends/str/registration/registration.hpp"

namespace evbench::str {

/// When a dot's track ends, and whether the dot is re-acquired when it comes back.
struct DotLifeOptions {
  double residual = 1.2;
  double radius = 0.3;
  double starvation = 15.0;
  bool find_again = false;
  double search = 4.0;

  void declare(OptionSet& set);
};

struct DotsOptions {
  BatchOptions batch;
  RegistrationOptions registration;
  SegmentationOptions segmentation;
  DotOptions dot;
  DotLifeOptions life;
  double sigma = 0.1;
  double delay = 0.05;

  DotsOptions() { registration.model = MotionModel::planar_4; }

  void declare(OptionSet& set);
};

}  // namespace evbench::str
