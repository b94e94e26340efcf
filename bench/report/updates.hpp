#pragma once

#include "bench/report/thinning.hpp"
#include "core/support/json.hpp"
#include "eval/run_record.hpp"

namespace evbench::report {

/// Adds what timing.csv of a run has: "updates", the slowest of equal parts of them, and "control_times" [s]
/// (bench/report/page/src/data.ts, Run); null without updates. Throws InputError for a damaged file.
void add_updates(const RunRecord& run, const Budget& budget, Json& json);

/// What estimated_parameters.csv of a run has (Parameters); null without one.
Json parameters_json(const RunRecord& run, const Budget& budget);

}  // namespace evbench::report
