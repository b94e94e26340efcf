#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace evbench {

/// Scripts with which a shell completes the program's commands, options, and values that are one of a few names; where
/// none of these can stand, files. Made from the declarations.
std::string bash_completion(const CLI::App& program);
std::string zsh_completion(const CLI::App& program);

}  // namespace evbench
