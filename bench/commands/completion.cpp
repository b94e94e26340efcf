#include "bench/commands/completion.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

#include "bench/commands/command_line.hpp"

namespace evbench {
namespace {

/// "'evbench eval --format') names='auto tum' ;;", a line of a case.
std::string line_of(const std::string& place, const std::string& name, const std::vector<std::string>& words) {
  if (words.empty()) return "";
  return fmt::format("    '{}') {}='{}' ;;\n", place, name, fmt::join(words, " "));
}

std::vector<std::string> names_of(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

/// The options and names of each command, as shell functions for both bash and zsh.
std::string tables_of(const CLI::App& program) {
  std::string flags, valued, names;
  std::vector<std::string> commands;
  for (const NamedCommand& at : all_commands(program)) {
    commands.push_back("'" + at.words + "'");
    std::vector<std::string> all, with_value, below;
    for (const CLI::App* command : at.command->get_subcommands({})) below.push_back(command->get_name());
    names += line_of(at.words + " 1", "names", below);
    int position = 0;
    for (const CLI::Option* option : at.command->get_options()) {
      const std::vector<std::string> choices = choices_of(*option);
      if (option->get_positional()) names += line_of(fmt::format("{} {}", at.words, ++position), "names", choices);
      for (const std::string& name : names_of(*option)) {
        all.push_back(name);
        if (takes_value(*option)) with_value.push_back(name);
        names += line_of(at.words + " " + name, "names", choices);
      }
    }
    flags += line_of(at.words, "flags", all);
    valued += line_of(at.words, "valued", with_value);
  }
  return fmt::format(R"(_evbench_is_command() {{
  case $1 in {}) return 0 ;; esac
  return 1
}}

_evbench_flags() {{  # COMMAND: its options
  flags=
  case $1 in
{}  esac
}}

_evbench_valued() {{  # COMMAND: its options that take a value
  valued=
  case $1 in
{}  esac
}}

_evbench_names() {{  # COMMAND PLACE: names for an option's value or for the positional of that number
  names=
  case "$1 $2" in
{}  esac
}}
)",
                     fmt::join(commands, " | "), flags, valued, names);
}

/// Sets `reached` and `place` by the words before the completed one. Bash splits --format=text and KEY=VALUE into three
/// words.
constexpr const char* kFind = R"(
_evbench_find() {
  local word waits= number=1
  reached=evbench
  for word in "$@"; do
    if [ "$word" = '=' ]; then
      waits=${waits:-value}
    elif [ -n "$waits" ]; then
      waits=
    elif _evbench_is_command "$reached $word"; then
      reached="$reached $word"
    else
      case $word in
        -*=*) ;;
        -*)
          _evbench_valued "$reached"
          case " $valued --plugin " in *" $word "*) waits=$word ;; esac ;;
        *) number=$((number + 1)) ;;
      esac
    fi
  done
  place=${waits:-$number}
}
)";

constexpr const char* kBash = R"(
_evbench() {
  local reached place flags valued names before=$((COMP_CWORD - 1)) current=${COMP_WORDS[COMP_CWORD]}
  if [ "$current" = '=' ]; then
    before=$COMP_CWORD
    current=
  fi
  _evbench_find "${COMP_WORDS[@]:1:before}"
  if [[ $current == -* && $place == [0-9]* ]]; then
    _evbench_flags "$reached"
    names=$flags
  else
    _evbench_names "$reached" "$place"
  fi
  COMPREPLY=($(compgen -W "$names" -- "$current"))
  return 0  # no match: bash completes files
}
complete -o default -F _evbench evbench
)";

constexpr const char* kZsh = R"(
_evbench() {
  local reached place flags valued names current=${words[CURRENT]}
  _evbench_find "${(@)words[2,CURRENT-1]}"
  if [[ $current == -*=* ]]; then
    place=${current%%=*}
    compset -P '*='
  fi
  if [[ $current == -* && $current != *=* && $place == [0-9]* ]]; then
    _evbench_flags "$reached"
    names=$flags
  else
    _evbench_names "$reached" "$place"
  fi
  if [[ -n $names ]]; then
    compadd -- ${=names}
  else
    _files
  fi
}

if [ "$funcstack[1]" = "_evbench" ]; then
  _evbench "$@"
else
  compdef _evbench evbench
fi
)";

}  // namespace

std::string bash_completion(const CLI::App& program) {
  return "# Completion for bash, made by evbench completion bash.\n\n" + tables_of(program) + kFind + kBash;
}

std::string zsh_completion(const CLI::App& program) {
  return "#compdef evbench\n# Completion for zsh, made by evbench completion zsh.\n\n" + tables_of(program) + kFind +
         kZsh;
}

}  // namespace evbench
