#include "bench/sweep/run_limits.hpp"

namespace evbench {

void RunLimits::declare(OptionSet& set) {
  set.add("timeout", seconds, "wall-clock time that a run may take [s]; 0: no limit").range(0.0);
  set.add("memory", memory_mib, "memory that a run may take [MiB]; 0: no limit").range(0.0);
}

}  // namespace evbench
