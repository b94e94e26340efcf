#pragma once

#include <string>

#include "bench/recordings/summary.hpp"
#include "core/plugin/registry.hpp"

namespace evbench {

/// Inputs of a new config besides the recording.
struct NewConfigOptions {
  std::string calibration, ground_truth;  ///< files; empty: those in the recording or in its folder
  ReadOptions read;
};

/// A config for a recording, with comments that say what was found in it: poisson's tracks, and a comparison of gp_map
/// and bundle_adjustment on them. Paths in it are relative to its path `place`. Throws InputError where no calibration
/// is known, and for any error that a run of the config would report.
std::string new_config(const std::string& recording, const RecordingSummary& summary, const NewConfigOptions& options,
                       const std::string& place, const Plugins& plugins);

}  // namespace evbench
