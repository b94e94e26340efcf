#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace evbench {

/// Adds --protocol NAME, one of the published protocols.
CLI::Option* add_protocol_name(CLI::App& command, std::string& protocol, const std::string& text);

}  // namespace evbench
