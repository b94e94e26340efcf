#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "eval/table.hpp"

// Common options of commands that evaluate runs.

namespace evbench {

/// Adds an option with a comma-separated list; `type`: its form in the help.
CLI::Option* add_list_option(CLI::App& command, const std::string& name, std::vector<std::string>& items,
                             const std::string& text, const std::string& type = "KEY,...");

/// Width of a printed text table [characters]: the terminal's; if the standard output is no terminal, that of the
/// environment variable COLUMNS, else 120.
std::size_t text_width();

/// The option --wide: prints all columns. Without it the width of the table is text_width().
void add_wide(CLI::App& command, TableLayout& layout, bool& wide);

/// Destination of a table.
struct TextOutput {
  std::string file;  ///< empty: the terminal
  bool force = false;

  /// Throws InputError if the file must not be written. Called before any work is done.
  void check() const;
  void write(const std::string& text) const;
};
void add_text_output(CLI::App& command, TextOutput& output);

}  // namespace evbench
