#pragma once

#include <string>

#include "bench/report/thinning.hpp"
#include "core/support/json.hpp"
#include "eval/run_record.hpp"

namespace evbench::report {

/// The trajectory of a sequence's ground truth as the page reads it; null if the run has none. Throws InputError for a
/// damaged file.
Json ground_truth_json(const RunRecord& run, const Budget& budget);

/// A run as the page reads it (bench/report/page/src/data.ts, Run), from the files of its folder, but for its name,
/// sequence and settings. Poses, landmarks and velocities are aligned as the run was scored. Throws InputError for
/// damaged files.
Json run_json(const RunRecord& run, const Budget& budget);

}  // namespace evbench::report
