#pragma once

#include "core/plugin/options.hpp"

namespace evbench {

/// What a run may use.
struct RunLimits {
  double seconds = 0.0;     ///< wall clock; 0: no limit
  double memory_mib = 0.0;  ///< resident memory of all its processes together; 0: no limit

  void declare(OptionSet& set) {
    set.add("timeout", seconds, "wall-clock time that a run may take [s]; 0: no limit").range(0.0);
    set.add("memory", memory_mib, "memory that a run may take [MiB]; 0: no limit").range(0.0);
  }
};

}  // namespace evbench
