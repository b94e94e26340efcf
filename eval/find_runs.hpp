#pragma once

#include <span>
#include <string>
#include <vector>

#include "eval/run_record.hpp"

namespace evbench {

/// Finds the runs in these folders and in all folders below them, each once. They are sorted by experiment, then in the
/// order of their config, then by label (numbers in names compare as numbers: 25 ms before 100 ms), settings, seed,
/// folder. Incomplete runs (NAME.evbench.part) and replaced ones (NAME.evbench.old) are skipped. Throws InputError for
/// a path that is not a folder, for a folder without any run, and for a damaged metrics.json, with the place.
/// `unreadable` gets a message for each run that can't be read, or whose metrics are missing; null: that is an error.
///
/// The runs of a sweep, whose folder has a sweep.json (sweep_record.hpp), are in its order, with their places on its
/// axes. Planned runs that are missing or can't be read have `done` false; runs that are not in the plan are skipped.
std::vector<RunRecord> find_runs(std::span<const std::string> folders, std::vector<std::string>* unreadable = nullptr);

/// Whether name `a` is before `b`. Digits compare by value, other characters as they are.
bool natural_less(const std::string& a, const std::string& b);

}  // namespace evbench
