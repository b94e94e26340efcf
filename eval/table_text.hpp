#pragma once

#include <string>
#include <vector>

#include "eval/table.hpp"

namespace evbench {

/// A table ready to be written: what each cell says, and what is said about the whole.
struct TextTable {
  struct Column {
    std::string header;
    bool number = true;  ///< numbers align right
  };
  struct Cell {
    std::string text;
    bool best = false;
  };
  std::vector<Column> columns;
  std::vector<std::vector<Cell>> rows;
  std::vector<std::string> notes;        ///< sentences, one a line
  std::vector<std::string> experiments;  ///< what it is of
};

/// Written out; characters with a meaning in the format are escaped. LaTeX is a float with caption, label and notes
/// that needs the package booktabs.
std::string format_table(const TextTable& table, TableFormat format);

std::string escape_latex(const std::string& text);

}  // namespace evbench
