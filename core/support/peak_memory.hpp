#pragma once

#include <fstream>
#include <string>

namespace evbench {

/// Peak resident memory of the process so far, from the kernel [MiB]; 0 if unknown.
inline double peak_memory_mib() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    double kib = 0.0;
    if (word == "VmHWM:" && status >> kib) return kib / 1024.0;
  }
  return 0.0;
}

}  // namespace evbench
