#include "core/process/process_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <sstream>

#include "core/io/path.hpp"
#include "core/process/line_tail.hpp"
#include "core/support/error.hpp"
#include "core/support/json.hpp"

namespace evbench::process {
namespace {

bool is_text(const Json& value) {
  return value.is_string() && value.get_ref<const std::string&>().find('\0') == std::string::npos;
}

/// The words of a command that may name files. Approximate for shell commands; the caller ignores files that do not
/// exist.
std::vector<std::string> possible_names(const Json& command) {
  std::vector<std::string> names;
  if (command.is_array()) {
    for (const Json& word : command) {
      if (is_text(word)) names.push_back(word.get<std::string>());
    }
  } else if (is_text(command)) {
    std::string plain = command.get<std::string>();
    std::erase_if(plain, [](char c) { return c == '"' || c == '\''; });
    std::ranges::replace_if(
        plain, [](char c) { return std::string_view(";|&<>()").find(c) != std::string::npos; }, ' ');
    std::istringstream words(plain);
    for (std::string word; words >> word;) names.push_back(word);
  }
  return names;
}

}  // namespace

void ProcessOptions::declare(OptionSet& set) {
  set.add("command", command, "the program and its arguments, a list of texts, or one text for the shell").required();
  set.add("folder", folder, "working directory, relative to the config's folder").folder();
  set.add("files", more_files, "further files that its result depends on (modules, weights), relative to `folder`");
  set.add("timeout", timeout, "time limit for each answer [s]").range(0.001, 1e6);
  set.add("options", options, "passed to the process unchanged");
}

std::vector<std::string> ProcessOptions::files() const {
  const std::string from = resolve_path(folder, "");
  const auto exists = [](const std::string& path) {
    std::error_code error;
    return std::filesystem::is_regular_file(path, error);
  };
  std::vector<std::string> result;
  const auto add = [&](const std::string& path) {
    if (std::ranges::find(result, path) == result.end()) result.push_back(path);
  };
  for (const std::string& name : possible_names(command)) {
    const std::string path = anchored_path(name, from);
    if (exists(path)) add(path);
  }
  if (!more_files.is_array() || !std::ranges::all_of(more_files, is_text)) {
    throw InputError(fmt::format("files: expected a list of texts, found {}", printable(dump_json(more_files), 60)));
  }
  for (const Json& name : more_files) {
    const std::string path = resolve_path(name.get<std::string>(), from);
    if (!exists(path)) throw InputError(fmt::format("{}: no such file; the option \"files\" names it", path));
    add(path);
  }
  return result;
}

std::vector<std::string> ProcessOptions::commands(const std::string& place) const {
  command_words(command, place);
  return {command_text(command)};
}

std::vector<std::string> command_words(const Json& command, const std::string& place) {
  if (is_text(command) && !command.get_ref<const std::string&>().empty()) {
    return {"/bin/sh", "-c", command.get<std::string>()};
  }
  const bool words = command.is_array() && !command.empty() && std::ranges::all_of(command, is_text) &&
                     !command[0].get_ref<const std::string&>().empty();
  if (!words) {
    throw InputError(
        fmt::format("{}.command: expected a list of texts (a program and its arguments) or one text for "
                    "the shell, found {}",
                    place, printable(dump_json(command), 60)));
  }
  return command.get<std::vector<std::string>>();
}

std::string command_text(const Json& command) {
  std::string result;
  if (command.is_string()) result = command.get<std::string>();
  for (const Json& word : command.is_array() ? command : Json::array()) {
    if (!result.empty()) result += ' ';
    result += word.is_string() ? word.get<std::string>() : dump_json(word);
  }
  return printable(result, 200);
}

}  // namespace evbench::process
