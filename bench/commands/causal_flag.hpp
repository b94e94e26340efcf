#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace evbench {

/// Declares --causal, and its name before version 1.0, --online, which is read for one version with a remark.
void add_causal_flag(CLI::App& command, bool& causal, const std::string& text);

}  // namespace evbench
