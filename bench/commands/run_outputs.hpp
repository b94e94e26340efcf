#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "eval/run_record.hpp"

// What commands have in common that look for runs and make something of them.

namespace evbench {

/// The folders that a command looks for runs in.
void add_folders(CLI::App& command, std::vector<std::string>& folders);

/// An option that takes a list, its items between commas; `type`: how the help shows it.
CLI::Option* add_list_option(CLI::App& command, const std::string& name, std::vector<std::string>& items,
                             const std::string& text, const std::string& type = "KEY,...");

/// Calls `use` with all runs of these folders (eval/find_runs.hpp). Those that can't be read are told when it is done;
/// then, and where there is no other run, throws InputError for the last of them.
void use_runs(const std::vector<std::string>& folders, const std::function<void(std::vector<RunRecord>&)>& use);

/// Where a table goes.
struct TextOutput {
  std::string file;  ///< empty: the terminal
  bool force = false;

  /// Throws InputError where the file must not be written: before any work is done.
  void check() const;
  void write(const std::string& text) const;
};
void add_text_output(CLI::App& command, TextOutput& output);

}  // namespace evbench
