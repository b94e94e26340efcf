#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace evbench {

/// The manual page evbench(1): every command with its options, generated from the declarations.
std::string man_page(const CLI::App& program);

}  // namespace evbench
