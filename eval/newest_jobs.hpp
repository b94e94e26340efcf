#pragma once

#include <cstddef>
#include <vector>

#include "eval/run_record.hpp"

namespace evbench {

/// Of runs that differ in nothing that their configs say (experiment, label, seed, settings, place in a sweep), and are
/// not the same job, as where a plugin was rebuilt or a recording replaced, only those of the newest job stay. Returns
/// how many were left out. Runs of which the config is not known all stay, and so do those that were not run.
///
/// Newest: by "finished" in manifest.json or, where an older version wrote the run, by when metrics.json was written.
std::size_t keep_newest_jobs(std::vector<RunRecord>& runs);

}  // namespace evbench
