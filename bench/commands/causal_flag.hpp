#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace evbench {

/// Adds --causal, and its old name --online, which is accepted for one version with a remark.
void add_causal_flag(CLI::App& command, bool& causal, const std::string& text);

}  // namespace evbench
