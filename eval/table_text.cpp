#include "eval/table_text.hpp"

#include <fmt/ranges.h>

#include <cctype>
#include <cstring>
#include <functional>

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

/// The header and all rows as texts, each cell written by `write`, padded to columns of equal width.
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

std::string format_text(const TextTable& table) {
  const auto rows = padded_rows(table, [](const Cell& cell) {
    if (cell.aside.empty()) return cell.text + (cell.best ? "*" : " ");
    return fmt::format("{}{} {} ", cell.text, cell.best ? "*" : "", cell.aside);
  });
  std::string text;
  for (const auto& row : rows) {
    std::string line = fmt::format("{}", fmt::join(row, " "));
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  for (const std::string& note : table.notes) text += note + "\n";
  return text;
}

std::string format_markdown(const TextTable& table) {
  const auto rows = padded_rows(table, [](const Cell& cell) {
    const std::string text = escape_markdown(cell.text), aside = escape_markdown(cell.aside);
    return (cell.best ? fmt::format("**{}**", text) : text) + (aside.empty() ? "" : " " + aside);
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

/// What may stand in a \\label.
std::string label_of(const TextTable& table) {
  std::string label = fmt::format("tab:{}", fmt::join(table.experiments, "+"));
  const auto safe = [](unsigned char c) {
    return std::isalnum(c) != 0 || (c != 0 && std::strchr(":+-._/", c) != nullptr);
  };
  std::ranges::replace_if(label, std::not_fn(safe), '-');
  return label;
}

std::string format_latex(const TextTable& table) {
  const auto rows = padded_rows(table, [](const Cell& cell) {
    const std::string text = escape_latex(cell.text), aside = escape_latex(cell.aside);
    return (cell.best ? fmt::format("\\textbf{{{}}}", text) : text) +
           (aside.empty() ? "" : fmt::format(" {{\\scriptsize {}}}", aside));
  });
  std::string alignment;
  for (const TextTable::Column& column : table.columns) alignment += column.number ? 'r' : 'l';
  std::string text = "\\begin{table}  % \\usepackage{booktabs}\n  \\centering\n";
  const std::string title = escape_latex(fmt::format("{}", fmt::join(table.experiments, ", ")));
  text += fmt::format("  \\caption[{{{0}}}]{{{0}.", title);
  for (const std::string& note : table.notes) text += fmt::format("\n    {}", escape_latex(note));
  text += "}\n";
  text += fmt::format("  \\label{{{}}}\n", label_of(table));
  text += fmt::format("  \\begin{{tabular}}{{{}}}\n    \\toprule\n", alignment);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    text += fmt::format("    {} \\\\\n", fmt::join(rows[r], " & "));
    if (r == 0) text += "    \\midrule\n";
  }
  return text + "    \\bottomrule\n  \\end{tabular}\n\\end{table}\n";
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

std::string escape_latex(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
      case '%':
      case '$':
      case '#':
      case '_':
      case '{':
      case '}': (result += '\\') += c; break;
      case '~': result += "\\textasciitilde{}"; break;
      case '^': result += "\\textasciicircum{}"; break;
      case '\\': result += "\\textbackslash{}"; break;
      case '<': result += "\\textless{}"; break;
      case '>': result += "\\textgreater{}"; break;
      case '|': result += "\\textbar{}"; break;
      case '[':
        result += result.empty() ? "{[}" : "[";
        break;  // first in a row it would be an argument of the line break
      case '\n': result += ' '; break;
      default: result += c;
    }
  }
  return result;
}

std::string format_table(const TextTable& table, TableFormat format) {
  switch (format) {
    case TableFormat::text: return format_text(table);
    case TableFormat::markdown: return format_markdown(table);
    case TableFormat::csv: return format_csv(table);
    case TableFormat::latex:
    case TableFormat::long_csv: break;
  }
  return format_latex(table);
}

}  // namespace evbench
