#include "eval/table_text.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <numeric>

#include "eval/table_latex.hpp"

namespace evbench {
namespace {

using Cell = TextTable::Cell;

std::string escape_markdown(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '|' || c == '*' || c == '_' || c == '`' || c == '<' || c == '\\') result += '\\';
    result += c == '\n' ? ' ' : c;
  }
  return result;
}

std::string escape_csv(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"') result += '"';
    result += c;
  }
  return result + '"';
}

/// Characters of UTF-8 text, not bytes.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(std::ranges::count_if(text, [](char c) { return (c & 0xC0) != 0x80; }));
}

std::string pad(const std::string& text, std::size_t width, bool right) {
  const std::string blanks(width - std::min(width, width_of(text)), ' ');
  return right ? blanks + text : text + blanks;
}

/// The header and all rows as text, each cell written by `write`, padded to columns of equal width.
std::vector<std::vector<std::string>> padded_rows(const TextTable& table,
                                                  const std::function<std::string(const Cell&)>& write) {
  std::vector<std::vector<std::string>> rows(1);
  for (const TextTable::Column& column : table.columns) rows[0].push_back(write({column.header}));
  for (const auto& cells : table.rows) {
    rows.emplace_back();
    for (const Cell& cell : cells) rows.back().push_back(write(cell));
  }
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    std::size_t width = 0;
    for (const auto& row : rows) width = std::max(width, width_of(row[c]));
    for (auto& row : rows) row[c] = pad(row[c], width, table.columns[c].number);
  }
  return rows;
}

/// The columns that fit, each of one width in all rows: those of the highest ranks are left out until the rest fits.
std::vector<std::size_t> fitting_columns(const TextTable& table, const std::vector<std::string>& cells,
                                         std::size_t width) {
  std::vector<std::size_t> columns(cells.size());
  std::iota(columns.begin(), columns.end(), 0);
  const auto rank = [&](std::size_t c) { return table.columns[c].rank; };
  const auto total = [&] {
    std::size_t sum = columns.size() - 1;
    for (const std::size_t c : columns) sum += width_of(cells[c]);
    return sum;
  };
  while (width > 0 && total() > width) {
    const auto last = std::ranges::max_element(columns, {}, rank);
    if (rank(*last) == 0) break;
    columns.erase(last);
  }
  return columns;
}

std::string format_text(const TextTable& table, std::size_t width) {
  const auto rows = padded_rows(table, [](const Cell& cell) {
    if (cell.detail.empty()) return cell.text + (cell.best ? "*" : " ");
    return fmt::format("{}{} {} ", cell.text, cell.best ? "*" : "", cell.detail);
  });
  const std::vector<std::size_t> columns = fitting_columns(table, rows.front(), width);
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    for (const std::size_t c : columns) line += (c == columns.front() ? "" : " ") + row[c];
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  std::vector<std::string> left_out;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    if (std::ranges::find(columns, c) == columns.end()) left_out.push_back(table.columns[c].header);
  }
  if (!left_out.empty()) {
    text += fmt::format("Left out for a width of {}: {} (evbench table --wide has all columns).\n", width,
                        fmt::join(left_out, "; "));
  }
  for (const std::string& note : table.notes) text += note + "\n";
  return text;
}

std::string format_markdown(const TextTable& table) {
  const auto rows = padded_rows(table, [](const Cell& cell) {
    const std::string text = escape_markdown(cell.text), detail = escape_markdown(cell.detail);
    return (cell.best ? fmt::format("**{}**", text) : text) + (detail.empty() ? "" : " " + detail);
  });
  std::string text;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    text += fmt::format("| {} |\n", fmt::join(rows[r], " | "));
    if (r > 0) continue;
    text += "|";
    for (const TextTable::Column& column : table.columns) text += column.number ? " ---: |" : " --- |";
    text += "\n";
  }
  for (const std::string& note : table.notes) text += "\n" + escape_markdown(note) + "\n";
  return text;
}

std::string format_csv(const TextTable& table) {
  std::vector<std::string> line;
  for (const TextTable::Column& column : table.columns) line.push_back(column.header);
  std::string text = csv_line(line);
  for (const auto& row : table.rows) {
    line.clear();
    for (const Cell& cell : row) line.push_back(cell.text);
    text += csv_line(line);
  }
  return text;
}

}  // namespace

std::string csv_line(const std::vector<std::string>& cells) {
  std::string line;
  for (const std::string& cell : cells) {
    if (&cell != &cells.front()) line += ',';
    line += escape_csv(cell);
  }
  return line + "\n";
}

const char* mark_name(TableFormat format) { return format == TableFormat::text ? "*" : "Bold"; }

std::string format_table(const TextTable& table, TableFormat format, const TableLayout& layout) {
  switch (format) {
    case TableFormat::text: return format_text(table, layout.width);
    case TableFormat::markdown: return format_markdown(table);
    case TableFormat::csv: return format_csv(table);
    case TableFormat::latex:
    case TableFormat::long_csv: break;
  }
  return format_latex(table, layout.body);
}

}  // namespace evbench
