#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "eval/run_record.hpp"

// Which runs a command makes something of.

namespace evbench {

/// The folders that a command looks for runs in.
void add_folders(CLI::App& command, std::vector<std::string>& folders);

/// Calls `use` with all runs of these folders (eval/find_runs.hpp). Those that can't be read are told when it is done;
/// then, and where there is no other run, throws InputError for the last of them.
void use_runs(const std::vector<std::string>& folders, const std::function<void(std::vector<RunRecord>&)>& use);

/// Runs below some folders, and which of them.
struct RunSelection {
  std::vector<std::string> folders;
  std::vector<std::string> only;    ///< "NAME=VALUE": keep_only()
  bool all = false;                 ///< older jobs of a label and config, too
  std::vector<std::string> labels;  ///< "OLD=NEW": rename_labels()
};

/// The folders and the options that choose among their runs.
void add_run_selection(CLI::App& command, RunSelection& selection);

/// use_runs() with those that are selected: of each label and config the newest job alone (eval/newest_jobs.hpp),
/// unless all are wanted. How many were left out is told on the standard error.
void use_runs(const RunSelection& selection, const std::function<void(std::vector<RunRecord>&)>& use);

/// Leaves the runs that have of each name, "NAME=VALUE", one of the values asked for. Names are those of run_columns(),
/// "key", and those of all settings. Throws InputError for other names, with the nearest, and where no run is left.
void keep_only(const std::vector<std::string>& only, std::vector<RunRecord>& runs);

/// Gives labels, "OLD=NEW", other names. Throws InputError for one that no run has, with the nearest.
void rename_labels(const std::vector<std::string>& renamed, std::vector<RunRecord>& runs);

/// Checks that a value of an option is of the form `shown`, e.g. KEY=VALUE.
CLI::Validator has_equals(const std::string& shown);

}  // namespace evbench
