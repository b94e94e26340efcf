#pragma once

#include <span>
#include <string>
#include <vector>

#include "eval/run_record.hpp"

namespace evbench {

/// The runs in these folders and in all folders below them, each once, by experiment, then in the order of their
/// config, then by label (numbers in names compare as numbers: 25 ms before 100 ms), settings, seed, folder. Runs that
/// are not complete (NAME.evbench.part) and replaced ones (NAME.evbench.old) are passed over. Throws InputError for a
/// path that is no folder, for a folder without any run, and for a metrics.json that is damaged, with the place.
/// `unreadable` gets a sentence for each run that can't be read, or whose metrics are missing; nullptr: such a one is
/// an InputError.
///
/// The runs of a sweep, whose folder has a sweep.json (sweep_record.hpp), stand in its order, with their places on its
/// axes; those that it plans and that are not there, or can't be read, have `done` false; those that it does not plan
/// (any more) are passed over.
std::vector<RunRecord> find_runs(std::span<const std::string> folders, std::vector<std::string>* unreadable = nullptr);

/// Does name `a` come before `b`? Digits compare by value, other characters as they are.
bool natural_less(const std::string& a, const std::string& b);

}  // namespace evbench
