#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

// The program's command line as a tree of commands, for messages, help, completion and the manual page.

namespace evbench {

/// A command and its words: "evbench dataset get".
struct NamedCommand {
  const CLI::App* command;
  std::string words;
};

/// The program and all of its commands and subcommands, in the order of their declaration.
std::vector<NamedCommand> all_commands(const CLI::App& program);

/// The command that the last parsing reached, also if it failed.
NamedCommand reached_command(const CLI::App& program);

/// The command of these words, from the program on; throws InputError, with the nearest name, for a word that is none.
NamedCommand find_command(const CLI::App& program, const std::vector<std::string>& words);

/// The names that an option or a positional accepts; empty if it accepts other values.
std::vector<std::string> choices_of(const CLI::Option& option);

bool takes_value(const CLI::Option& option);

/// "Usage: evbench run [OPTIONS] config".
std::string usage_of(const NamedCommand& command);

/// The text of `--help`.
std::string help_of(const NamedCommand& command);

/// The message for a command line that can't be parsed, with the nearest name for an unknown command or option.
std::string explain(const CLI::App& program, const CLI::ParseError& error, const std::vector<std::string>& words);

}  // namespace evbench
