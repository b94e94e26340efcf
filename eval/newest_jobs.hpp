#pragma once

#include <cstddef>
#include <vector>

#include "eval/run_record.hpp"

namespace evbench {

/// Keeps only the newest job of runs with equal configs (experiment, label, seed, settings, place in a sweep) that are
/// different jobs, e.g. because a plugin was rebuilt or a recording replaced. Returns how many runs were left out. Runs
/// without a known config, and those that were not run, are kept.
///
/// The newest is determined by "finished" in manifest.json or, for runs of older versions, by the time of metrics.json.
std::size_t keep_newest_jobs(std::vector<RunRecord>& runs);

}  // namespace evbench
