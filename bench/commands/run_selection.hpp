#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "eval/run_record.hpp"

// Selection of the runs that a command evaluates.

namespace evbench {

/// The folders in which a command searches for runs.
void add_folders(CLI::App& command, std::vector<std::string>& folders);

/// Calls `use` with all runs of these folders (eval/find_runs.hpp). Afterwards throws an error with the runs that can't
/// be read, if there are any.
void use_runs(const std::vector<std::string>& folders, const std::function<void(std::vector<RunRecord>&)>& use);

/// Folders, and which of their runs are selected.
struct RunSelection {
  std::vector<std::string> folders;
  std::vector<std::string> only;    ///< "NAME=VALUE": keep_only()
  bool all = false;                 ///< also older jobs of a label and config
  std::vector<std::string> labels;  ///< "OLD=NEW": rename_labels()
};

/// The folders and the options that select among their runs.
void add_run_selection(CLI::App& command, RunSelection& selection);

/// use_runs() with the selected runs: of each label and config only the newest job (eval/newest_jobs.hpp), unless
/// `all`. Reports on the standard error how many were left out.
void use_runs(const RunSelection& selection, const std::function<void(std::vector<RunRecord>&)>& use);

/// Keeps the runs that have one of the given values of each name ("NAME=VALUE"). Names are those of run_columns(),
/// "key", and all settings. Throws InputError for other names, with the nearest, and if no run is left.
void keep_only(const std::vector<std::string>& only, std::vector<RunRecord>& runs);

/// Renames labels ("OLD=NEW"). Throws InputError for a label that no run has, with the nearest.
void rename_labels(const std::vector<std::string>& renamed, std::vector<RunRecord>& runs);

/// Checks that a value of an option is of the form `shown`, e.g. KEY=VALUE.
CLI::Validator has_equals(const std::string& shown);

}  // namespace evbench
