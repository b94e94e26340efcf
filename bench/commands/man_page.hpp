#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace evbench {

/// The manual page evbench(1), for man: every command with its options, made from the declarations.
std::string man_page(const CLI::App& program);

}  // namespace evbench
