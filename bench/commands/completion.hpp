#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace evbench {

/// Scripts with which a shell completes commands, options and named values, and files everywhere else. Generated from
/// the declarations.
std::string bash_completion(const CLI::App& program);
std::string zsh_completion(const CLI::App& program);

}  // namespace evbench
