#pragma once

#include <string>

#include "eval/table_text.hpp"

namespace evbench {

/// A table for LaTeX, with the packages booktabs and siunitx: numbers are aligned by their decimal points, details of
/// cells are a separate column. It is a float with a caption and a label or, with `body`, only the tabular, with the
/// notes as comments before it.
std::string format_latex(const TextTable& table, bool body);

/// Escapes characters with a meaning in LaTeX.
std::string escape_latex(const std::string& text);

}  // namespace evbench
