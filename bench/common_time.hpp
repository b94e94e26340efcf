#pragma once

#include <span>

#include "eval/run_record.hpp"

namespace evbench {

/// Scores the runs of each experiment and sequence (run_columns.hpp) once more, by their own protocols, over the time
/// that all of them cover: from the latest first pose to the earliest last one, of the final or of the causal
/// trajectories. Sets common_scores: null for runs that have no scores, or whose files can't be read, and where there
/// is no such time. Lost and failed runs have no say in what is common. On as many threads as there are processors.
void score_common_time(std::span<RunRecord> runs, bool causal);

}  // namespace evbench
