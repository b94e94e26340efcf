#pragma once

#include <string>
#include <vector>

#include "eval/run_settings.hpp"

namespace evbench {

/// A planned run of a sweep.
struct SweepRecordRun {
  std::string key;    ///< name of its folder, next to sweep.json
  std::string label;  ///< of its back-end
  RunAxes axes;       ///< its value on each of its axes
};

/// The plan of a sweep: sweep.json in its folder,
/// {"name", "axes": [{"name", "values": [text...]}], "runs": [{"key", "label", "axes": {AXIS: value}}]}.
struct SweepRecord {
  std::string name;
  std::vector<SweepRecordRun> runs;  ///< all of them, done or not, in its order
};

/// Throws InputError with the place for a file that can't be read or has another structure.
SweepRecord read_sweep_record(const std::string& path);

}  // namespace evbench
