#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "eval/table.hpp"

// What commands have in common that make something of runs.

namespace evbench {

/// An option that takes a list, its items between commas; `type`: how the help shows it.
CLI::Option* add_list_option(CLI::App& command, const std::string& name, std::vector<std::string>& items,
                             const std::string& text, const std::string& type = "KEY,...");

/// The width of a table of text that is printed [characters]: the terminal's; where the standard output is none, what
/// the environment variable COLUMNS says, else 120.
std::size_t text_width();

/// The option --wide: all columns, however wide the table gets. It overrides `width`, which is set to text_width().
void add_wide(CLI::App& command, TableLayout& layout, bool& wide);

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
