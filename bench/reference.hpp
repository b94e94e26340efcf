#pragma once

#include <span>
#include <string>

#include "eval/run_record.hpp"

namespace evbench {

/// How far these runs of one experiment are from results that were written before: a CSV of `evbench table --format
/// csv` with a row per run. Of each metric of errors the largest relative difference over the runs with the same label,
/// seed and place on the axes of a sweep, and the run in which it is, as sentences. Throws InputError for a file that is no such table.
std::string compare_with_reference(std::span<const RunRecord> runs, const std::string& csv);

}  // namespace evbench
