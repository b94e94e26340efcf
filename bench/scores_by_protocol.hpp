#pragma once

#include <span>
#include <string>

#include "eval/run_record.hpp"
#include "eval/scores.hpp"

namespace evbench {

/// The named protocol (eval/protocols.hpp) with the run's options of the data, or the run's own if the name is empty.
ScoreOptions protocol_of(const RunRecord& run, const std::string& protocol);

/// Replaces the scores of these runs by those of a named protocol, in memory. A run whose files are damaged has none,
/// and the reason. Throws InputError for an unknown name.
void score_by_protocol(std::span<RunRecord> runs, const std::string& protocol);

/// Scores the runs of each experiment and sequence (run_columns.hpp) by their own protocols, or the named one, over
/// their common time: from the latest first pose to the earliest last pose of the final or causal trajectories. Lost
/// and failed runs do not shorten it. Sets common_scores: null for runs that have no scores or unreadable files, and if
/// there is no common time. Uses as many threads as there are processors.
void score_common_time(std::span<RunRecord> runs, bool causal, const std::string& protocol = "");

}  // namespace evbench
