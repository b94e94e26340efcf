#include "bench/commands/man_page.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string>
#include <utility>
#include <vector>

#include "bench/commands/command_line.hpp"
#include "bench/commands/exit_code.hpp"

namespace evbench {
namespace {

/// Escapes text for man's macros.
std::string escaped(const std::string& text) {
  std::string result;
  bool begins = true;  // a line
  for (const char c : text) {
    if (begins && (c == '.' || c == '\'')) result += "\\&";
    if (c == '-') result += '\\';
    result += c == '\\' ? "\\e" : std::string(1, c);
    begins = c == '\n';
  }
  return result;
}

std::string bold(const std::string& text) { return "\\fB" + escaped(text) + "\\fR"; }

/// "--out TEXT (results)" and the description.
std::string item(const CLI::Option& option) {
  std::string text = ".TP\n";
  if (option.get_positional()) {
    text += bold(option.get_name(true, false));
  } else {
    std::string names;
    for (const std::string& name : option.get_snames()) names += (names.empty() ? "" : ", ") + bold("-" + name);
    for (const std::string& name : option.get_lnames()) names += (names.empty() ? "" : ", ") + bold("--" + name);
    text += names;
  }
  if (takes_value(option)) {
    const std::vector<std::string> choices = choices_of(option);
    const std::string type = choices.empty() ? option.get_type_name() : fmt::format("{}", fmt::join(choices, " | "));
    if (!(option.get_positional() && type == "TEXT")) text += " \\fI" + escaped(type) + "\\fR";
    if (!option.get_default_str().empty()) text += escaped(" (" + option.get_default_str() + ")");
  }
  text += "\n" + escaped(option.get_description());
  if (!option.get_envname().empty()) text += escaped("; also set by the environment variable " + option.get_envname());
  return text + "\n";
}

std::string items(const CLI::App& command) {
  std::string positionals, options;
  for (const CLI::Option* option : command.get_options()) {
    const bool of_program = option == command.get_help_all_ptr() && command.get_parent() != nullptr;
    if (option == command.get_help_ptr() || of_program) continue;
    (option->get_positional() ? positionals : options) += item(*option);
  }
  return positionals + options;
}

/// Unfilled: the lines of the footer are kept.
std::string footer(const CLI::App& command) {
  const std::string text = command.get_footer();
  return text.empty() ? "" : fmt::format(".PP\n.nf\n{}\n.fi\n", escaped(text));
}

}  // namespace

std::string man_page(const CLI::App& program) {
  std::string page = ".TH EVBENCH 1 \"\" evbench \"User Commands\"\n.ad l\n.nh\n.SH NAME\n" +
                     escaped("evbench - a benchmark harness for back-ends of event-camera visual odometry") +
                     "\n.SH SYNOPSIS\n" + bold("evbench") + escaped(" COMMAND [OPTIONS] ...") +
                     "\n.SH OPTIONS\nOf every command:\n" + items(program) + ".SH COMMANDS\n";
  for (const NamedCommand& at : all_commands(program)) {
    if (at.command == &program) continue;
    const std::string usage = usage_of(at);
    page += ".SS " + escaped(usage.substr(usage.find(": ") + 2)) + "\n" + escaped(at.command->get_description()) +
            "\n" + items(*at.command) + footer(*at.command);
  }
  page += ".SH EXIT STATUS\n";
  constexpr std::pair<int, const char*> kCodes[] = {
      {kExitDone, "done"},
      {kExitBadInput, "a command line, config or file that can't be used"},
      {kExitFailed, "a run or a check failed; the others were done"},
      {kExitNotWritten, "an output can't be written"}};
  for (const auto& [code, text] : kCodes) page += fmt::format(".TP\n{}\n{}\n", code, escaped(text));
  return page + ".TP\n" + escaped("128 + n") + "\nit was ended by signal n\n";
}

}  // namespace evbench
