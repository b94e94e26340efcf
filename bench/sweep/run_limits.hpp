#pragma once

#include "core/plugin/options.hpp"

namespace evbench {

/// Limits of a run.
struct RunLimits {
  double seconds = 0.0;     ///< wall clock; 0: no limit
  double memory_mib = 0.0;  ///< resident memory of all its processes together; 0: no limit

  void declare(OptionSet& set);
};

}  // namespace evbench
