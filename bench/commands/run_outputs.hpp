#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

// What commands have in common that make something of runs.

namespace evbench {

/// An option that takes a list, its items between commas; `type`: how the help shows it.
CLI::Option* add_list_option(CLI::App& command, const std::string& name, std::vector<std::string>& items,
                             const std::string& text, const std::string& type = "KEY,...");

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
