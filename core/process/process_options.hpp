#pragma once

#include <string>
#include <vector>

#include "core/plugin/options.hpp"
#include "core/support/json.hpp"

namespace evbench::process {

/// Options common to plugins that are processes.
struct ProcessOptions {
  Json command;                     ///< a list of words or one text for the shell
  std::string folder = ".";         ///< working directory
  Json more_files = Json::array();  ///< "files"
  double timeout = 60.0;            ///< [s]
  Json options = Json::object();    ///< passed to the process unchanged

  void declare(OptionSet& set);

  /// The words of the command that name files, and `more_files`: their content is part of a run's identity. Throws
  /// InputError if one of `more_files` does not exist.
  std::vector<std::string> files() const;

  /// The command as shown in messages. Throws InputError like command_words().
  std::vector<std::string> commands(const std::string& place) const;
};

/// The command as words to execute. Throws InputError if it is empty or neither a text nor a list of texts.
std::vector<std::string> command_words(const Json& command, const std::string& place);

/// The command as shown in messages.
std::string command_text(const Json& command);

}  // namespace evbench::process
