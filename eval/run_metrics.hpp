#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/plugin/options.hpp"

namespace evbench {

/// The metrics.json of a run (metrics.md).
struct RunMetrics {
  std::string folder;      ///< where it was found
  std::string experiment;  ///< runs of one experiment are compared with one another
  std::string label;       ///< the run's name within it
  Json metrics;            ///< the whole object
};

/// The runs in these folders and in all folders below them, each once, by experiment, then label (numbers in names
/// compare as numbers: 25 ms before 100 ms), then folder. Runs that are not complete (NAME.evbench.part) and replaced
/// ones (NAME.evbench.old) are passed over. Throws InputError for a path that is no folder, for a folder without any
/// run, and for a metrics.json that is damaged, with the place.
std::vector<RunMetrics> find_runs(std::span<const std::string> folders);

/// Does name `a` come before `b`? Digits compare by value, other characters as they are.
bool natural_less(const std::string& a, const std::string& b);

}  // namespace evbench
