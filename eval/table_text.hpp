#pragma once

#include <optional>
#include <string>
#include <vector>

#include "eval/table.hpp"

namespace evbench {

/// A table as text: the cells and the notes.
struct TextTable {
  struct Column {
    std::string header;
    bool number = true;    ///< numbers align right
    std::size_t rank = 0;  ///< columns of the highest rank are left out first if not all fit; 0: never left out
    std::string key = {};  ///< of the metric; empty: it is none
  };
  struct Cell {
    std::string text;
    bool best = false;                 ///< of the text
    std::string detail = {};           ///< printed after the text, small in LaTeX
    std::optional<double> value = {};  ///< of the text, unrounded; none: it is no number
  };
  std::vector<Column> columns;
  std::vector<std::vector<Cell>> rows;
  std::vector<std::vector<std::size_t>> runs;  ///< of each row, by index; empty where rows are not of runs
  std::vector<std::string> notes;              ///< one per line
  std::vector<std::string> experiments;        ///< experiments of the runs
};

/// Formats a table; characters with a meaning in the format are escaped. LaTeX is a float with a label and the notes in
/// its caption; it needs the packages booktabs and siunitx, which aligns numbers by their decimal points. Not for the
/// format long.
std::string format_table(const TextTable& table, TableFormat format, const TableLayout& layout = {});

/// The mark of the best value: "*" in text, else "Bold".
const char* mark_name(TableFormat format);

/// A line of CSV.
std::string csv_line(const std::vector<std::string>& cells);

}  // namespace evbench
