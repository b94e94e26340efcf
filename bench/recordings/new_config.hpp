#pragma once

#include <string>

#include "bench/recordings/summary.hpp"
#include "core/plugin/registry.hpp"

namespace evbench {

/// What a new config is made of besides the recording.
struct NewConfigOptions {
  std::string calibration, ground_truth;  ///< files, instead of what is in or beside the recording; empty: that
  ReadOptions read;
};

/// A config for a recording, with comments that say what was found in it: haste's tracks, and a comparison of gp_map
/// and bundle_adjustment on them. It stands at `place`, which paths in it are relative to. Throws InputError where no
/// calibration is known, and for whatever a run of the config would refuse.
std::string new_config(const std::string& recording, const RecordingSummary& summary, const NewConfigOptions& options,
                       const std::string& place, const Plugins& plugins);

}  // namespace evbench
