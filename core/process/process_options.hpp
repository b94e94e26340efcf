#pragma once

#include <string>
#include <vector>

#include "core/plugin/options.hpp"
#include "core/support/json.hpp"

namespace evbench::process {

/// The options that plugins which are processes have in common.
struct ProcessOptions {
  Json command;                     ///< a list of words, or one text for the shell
  std::string folder = ".";         ///< where it runs
  Json more_files = Json::array();  ///< "files"
  double timeout = 60.0;            ///< [s]
  Json options = Json::object();    ///< told to the process as they are

  void declare(OptionSet& set);

  /// Those words of the command that name files, and `more_files`: their content is part of a run's identity.
  /// Throws InputError for one of `more_files` that does not exist.
  std::vector<std::string> files() const;

  /// The command, as it is shown in messages. Throws InputError as command_words().
  std::vector<std::string> commands(const std::string& place) const;
};

/// The command as words to be executed. Throws InputError when it is neither a text nor a list of texts, or empty.
std::vector<std::string> command_words(const Json& command, const std::string& place);

/// The command as it is shown in messages.
std::string command_text(const Json& command);

}  // namespace evbench::process
