#pragma once

#include <string>
#include <vector>

#include "bench/report/thinning.hpp"
#include "core/support/json.hpp"
#include "eval/run_record.hpp"

namespace evbench::report {

/// The trajectory of a sequence's ground truth as the page reads it; null if the run has none, or a damaged
/// file.
Json ground_truth_json(const RunRecord& run, const Budget& budget);

/// A run as the page reads it (bench/report/page/src/data.ts, Run), from the files of its folder, but for its name,
/// sequence and settings. Poses, landmarks and velocities are aligned by the protocol: a name, or empty for the run's
/// own. Parts whose files are damaged are left out, and `damage` gets the reasons.
Json run_json(const RunRecord& run, const std::string& protocol, const Budget& budget,
              std::vector<std::string>& damage);

}  // namespace evbench::report
