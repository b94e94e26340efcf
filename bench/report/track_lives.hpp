#pragma once

#include "bench/report/thinning.hpp"
#include "core/support/json.hpp"
#include "eval/run_record.hpp"

namespace evbench::report {

/// When each of a run's tracks lived and was found again, and how many lived at each time, from tracks.txt and
/// track_ends.txt (bench/report/page/src/data.ts, Tracks). Null if the run kept no tracks. Throws InputError for
/// damaged files.
Json tracks_json(const RunRecord& run, const Budget& budget);

}  // namespace evbench::report
