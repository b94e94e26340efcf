#include "bench/commands/command_line.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <sstream>

#include "core/support/error.hpp"
#include "core/support/nearest.hpp"

namespace evbench {
namespace {

std::vector<std::string> names_of(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::App* below : command.get_subcommands({})) names.push_back(below->get_name());
  return names;
}

const CLI::App* command_below(const CLI::App& command, const std::string& name) {
  for (const CLI::App* below : command.get_subcommands({})) {
    if (below->get_name() == name) return below;
  }
  return nullptr;
}

std::string no_command(const std::string& word, const CLI::App& command) {
  return fmt::format("\"{}\" is no command{}", word, suggestion(word, names_of(command)));
}

/// The message for a word in the place of a command that is none; empty if there is no such word.
std::string unknown_command(const CLI::App& program, const std::vector<std::string>& words) {
  const CLI::App* place = &program;
  for (const std::string& word : words) {
    if (names_of(*place).empty() || word.empty() || word.starts_with('-')) return "";
    const CLI::App* below = command_below(*place, word);
    if (below == nullptr) return no_command(word, *place);
    place = below;
  }
  return "";
}

/// Names of the options that may follow a command: its own and those of the commands above it.
std::vector<std::string> option_names(const CLI::App* command) {
  std::vector<std::string> names;
  for (; command != nullptr; command = command->get_parent()) {
    for (const CLI::Option* option : command->get_options()) {
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
      for (const std::string& name : option->get_snames()) names.push_back("-" + name);
    }
  }
  return names;
}

/// The message for the words that no option or positional takes.
std::string unexpected(const CLI::App* command, std::vector<std::string> words) {
  const std::vector<std::string> names = option_names(command);
  for (const std::string& word : words) {
    const std::string name = word.substr(0, word.find('='));
    if (!word.starts_with('-') || std::ranges::find(names, name) != names.end()) continue;
    return fmt::format("there is no option {}{}", name, suggestion(name, names));
  }
  return fmt::format("\"{}\" {} not expected", fmt::join(words, "\", \""), words.size() == 1 ? "is" : "are");
}

}  // namespace

std::vector<NamedCommand> all_commands(const CLI::App& program) {
  std::vector<NamedCommand> commands = {{&program, program.get_name()}};
  for (std::size_t i = 0; i < commands.size(); ++i) {
    const NamedCommand above = commands[i];
    auto place = commands.begin() + static_cast<std::ptrdiff_t>(i) + 1;
    for (const CLI::App* below : above.command->get_subcommands({})) {
      place = commands.insert(place, {below, above.words + " " + below->get_name()}) + 1;
    }
  }
  return commands;
}

NamedCommand reached_command(const CLI::App& program) {
  NamedCommand reached{&program, program.get_name()};
  while (!reached.command->get_subcommands().empty()) {
    reached.command = reached.command->get_subcommands().back();
    reached.words += " " + reached.command->get_name();
  }
  return reached;
}

NamedCommand find_command(const CLI::App& program, const std::vector<std::string>& words) {
  NamedCommand found{&program, program.get_name()};
  for (const std::string& word : words) {
    const CLI::App* below = command_below(*found.command, word);
    if (below == nullptr) throw InputError(no_command(word, *found.command));
    found = {below, found.words + " " + word};
  }
  return found;
}

/// CLI11 keeps them in the name of the type alone: "TEXT:{text,csv}".
std::vector<std::string> choices_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t from = type.find('{'), to = type.find('}', from);
  std::vector<std::string> choices;
  if (to == std::string::npos) return choices;
  std::istringstream names(type.substr(from + 1, to - from - 1));
  for (std::string name; std::getline(names, name, ',');) choices.push_back(name);
  return choices;
}

bool takes_value(const CLI::Option& option) { return option.get_items_expected_max() > 0; }

std::string usage_of(const NamedCommand& command) {
  std::string usage = CLI::Formatter().make_usage(command.command, command.words);
  while (usage.ends_with('\n')) usage.pop_back();
  return usage;
}

std::string help_of(const NamedCommand& command) {
  return command.command->get_formatter()->make_help(command.command, command.words, CLI::AppFormatMode::Normal);
}

std::string explain(const CLI::App& program, const CLI::ParseError& error, const std::vector<std::string>& words) {
  if (std::string text = unknown_command(program, words); !text.empty()) return text;
  const CLI::App* command = reached_command(program).command;
  const std::vector<std::string> left = program.remaining(true);
  if (std::ranges::any_of(left, [](const std::string& word) { return word.starts_with('-'); })) {
    return unexpected(command, left);
  }
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) return unexpected(command, left);
  const std::vector<std::string> names = names_of(*command);
  if (!names.empty()) return fmt::format("expected a command: {}", fmt::join(names, ", "));
  return error.what();
}

}  // namespace evbench
