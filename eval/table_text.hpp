#pragma once

#include <string>
#include <vector>

#include "eval/table.hpp"

namespace evbench {

/// A table ready to be written: what each cell says, and what is said about the whole.
struct TextTable {
  struct Column {
    std::string header;
    bool number = true;    ///< numbers align right
    std::size_t rank = 0;  ///< where there is no room for all, columns of the highest rank go first; 0: it stays
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

/// Written out; characters with a meaning in the format are escaped. LaTeX is a float that needs the packages booktabs
/// and siunitx, which aligns numbers by their points, with a label, and the notes in its caption. Not for the format
/// long.
std::string format_table(const TextTable& table, TableFormat format, const TableLayout& layout = {});

/// How the best value is marked: "*" in text, else "Bold".
const char* mark_name(TableFormat format);

/// A line of CSV.
std::string csv_line(const std::vector<std::string>& cells);

}  // namespace evbench
