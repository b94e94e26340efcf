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
    bool best = false;       ///< of the text
    std::string aside = {};  ///< behind it, small in print
  };
  std::vector<Column> columns;
  std::vector<std::vector<Cell>> rows;
  std::vector<std::string> notes;        ///< sentences, one a line
  std::vector<std::string> experiments;  ///< what it is of
};

/// Written out; characters with a meaning in the format are escaped. LaTeX is a float that needs the package booktabs,
/// with a label, and the notes in its caption. Not for the format long.
std::string format_table(const TextTable& table, TableFormat format);

/// A line of CSV.
std::string csv_line(const std::vector<std::string>& cells);

std::string escape_latex(const std::string& text);

}  // namespace evbench
