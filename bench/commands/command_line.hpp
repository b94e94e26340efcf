#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

// The program's command line as a tree of commands: what messages, help, completion and the manual page walk over.

namespace evbench {

/// A command and the words that call it: "evbench dataset get".
struct NamedCommand {
  const CLI::App* command;
  std::string words;
};

/// The program and all of its commands, those of commands included, in the order of their declaration.
std::vector<NamedCommand> all_commands(const CLI::App& program);

/// The command that the last parsing reached, also where it failed.
NamedCommand reached_command(const CLI::App& program);

/// The command of these words, from the program on; throws InputError, with the nearest name, for a word that is none.
NamedCommand find_command(const CLI::App& program, const std::vector<std::string>& words);

/// What an option or a positional takes, where it is one of a few names; else none.
std::vector<std::string> choices_of(const CLI::Option& option);

/// Does it take a value?
bool takes_value(const CLI::Option& option);

/// A line: "Usage: evbench run [OPTIONS] config".
std::string usage_of(const NamedCommand& command);

/// What `--help` prints.
std::string help_of(const NamedCommand& command);

/// What a command line is told that can't be parsed: a sentence, with the nearest name where there is no such command
/// or option.
std::string explain(const CLI::App& program, const CLI::ParseError& error, const std::vector<std::string>& words);

}  // namespace evbench
