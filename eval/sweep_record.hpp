#pragma once

#include <string>
#include <vector>

#include "eval/run_settings.hpp"

namespace evbench {

/// A run that a sweep plans.
struct SweepRecordRun {
  std::string key;    ///< its folder's name, beside sweep.json
  std::string label;  ///< of its back-end
  RunAxes axes;       ///< its value on each axis that it has
};

/// What a sweep is of: sweep.json in its folder,
/// {"name", "axes": [{"name", "values": [text...]}], "runs": [{"key", "label", "axes": {AXIS: value}}]}.
struct SweepRecord {
  std::string name;
  std::vector<SweepRecordRun> runs;  ///< all of them, done or not, in its order
};

/// Throws InputError with the place for a file that can't be read or is not of this structure.
SweepRecord read_sweep_record(const std::string& path);

}  // namespace evbench
