#pragma once

#include <string>

#include "eval/table_text.hpp"

namespace evbench {

/// A table for LaTeX, with the packages booktabs and siunitx: numbers are aligned by their points, what stands beside
/// them is a column of its own. A float with a caption and a label, or `body`: the tabular alone, the notes as comments
/// before it.
std::string format_latex(const TextTable& table, bool body);

/// Text with the characters escaped that have a meaning in LaTeX.
std::string escape_latex(const std::string& text);

}  // namespace evbench
