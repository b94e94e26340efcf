#include "eval/table_latex.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <functional>
#include <optional>
#include <regex>

namespace evbench {
namespace {

using Cell = TextTable::Cell;

/// Numbers of characters before and after the decimal point, and in the exponents, of a column's numbers.
struct Digits {
  std::size_t before = 1, behind = 0, exponent = 0;
  bool minus = false, minus_exponent = false;
};

const std::regex kNumber(R"((-?)(\d+)(?:\.(\d+))?(?:e([+-]?)0*(\d+))?)");

void add_digits(const std::smatch& match, Digits& digits) {
  const auto length = [&](int part) { return static_cast<std::size_t>(match.length(part)); };
  digits.minus = digits.minus || length(1) > 0;
  digits.before = std::max(digits.before, length(2));
  digits.behind = std::max(digits.behind, length(3));
  digits.exponent = std::max(digits.exponent, length(5));
  digits.minus_exponent = digits.minus_exponent || match.str(4) == "-";
}

/// A column of the table, and how it is aligned.
struct Column {
  bool number;                   ///< of numbers, or of text that is aligned like numbers
  std::optional<Digits> digits;  ///< for alignment by decimal points; none: a cell is not a single number
  bool detail = false;           ///< its cells have details
};

/// Whether the text is the placeholder of a missing number.
bool is_no_number(const std::string& text) { return text == "-" || text == "fails" || text == "inf"; }

Column column_of(const TextTable& table, std::size_t c) {
  Column column{table.columns[c].number, std::nullopt};
  bool all_numbers = column.number;
  Digits digits;
  bool any = false;
  for (const auto& row : table.rows) {
    column.detail = column.detail || !row[c].detail.empty();
    std::smatch match;
    if (std::regex_match(row[c].text, match, kNumber)) {
      add_digits(match, digits);
      any = true;
    } else {
      all_numbers = all_numbers && is_no_number(row[c].text);
    }
  }
  if (all_numbers && any) column.digits = digits;
  return column;
}

std::string alignment_of(const Column& column) {
  if (!column.number) return "l";
  std::string text = "r";
  if (column.digits) {
    const Digits& digits = *column.digits;
    text = fmt::format("S[detect-weight, mode=text, table-format={}{}.{}", digits.minus ? "-" : "", digits.before,
                       digits.behind);
    if (digits.exponent > 0) text += fmt::format("e{}{}", digits.minus_exponent ? "-" : "", digits.exponent);
    text += "]";
  }
  return text + (column.detail ? "@{\\,}l" : "");
}

std::string header_of(const std::string& header, const Column& column) {
  const std::string text = escape_latex(header);
  if (column.detail) return fmt::format("\\multicolumn{{2}}{{c}}{{{}}}", text);
  return column.digits ? fmt::format("{{{}}}", text) : text;
}

/// The text of a cell. In a column that siunitx aligns, text that is not a number is put in braces.
std::string text_of(const Cell& cell, const Column& column) {
  std::string text = escape_latex(cell.text);
  std::smatch match;
  const bool number = std::regex_match(cell.text, match, kNumber);
  if (column.digits && !number) text = fmt::format("{{{}}}", text == "-" ? "--" : text);
  if (column.digits && number && match.length(5) > 0) {
    text = fmt::format("{}e{}{}", text.substr(0, text.find('e')), match.str(4) == "-" ? "-" : "", match.str(5));
  }
  if (cell.best) text = column.digits && number ? "\\bfseries " + text : fmt::format("\\textbf{{{}}}", text);
  if (column.detail) {
    text += cell.detail.empty() ? " &" : fmt::format(" & {{\\scriptsize {}}}", escape_latex(cell.detail));
  }
  return text;
}

/// A valid name for \\label.
std::string label_of(const TextTable& table) {
  std::string label = fmt::format("tab:{}", fmt::join(table.experiments, "+"));
  const auto safe = [](unsigned char c) {
    return std::isalnum(c) != 0 || (c != 0 && std::strchr(":+-._/", c) != nullptr);
  };
  std::ranges::replace_if(label, std::not_fn(safe), '-');
  return label;
}

std::string tabular(const TextTable& table, const std::string& indent) {
  std::vector<Column> columns;
  std::string alignment;
  std::vector<std::string> header;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    columns.push_back(column_of(table, c));
    alignment += alignment_of(columns.back());
    header.push_back(header_of(table.columns[c].header, columns.back()));
  }
  std::string text = fmt::format("{}\\begin{{tabular}}{{{}}}\n{}  \\toprule\n", indent, alignment, indent);
  text += fmt::format("{}  {} \\\\\n{}  \\midrule\n", indent, fmt::join(header, " & "), indent);
  for (const auto& row : table.rows) {
    std::vector<std::string> cells;
    for (std::size_t c = 0; c < row.size(); ++c) cells.push_back(text_of(row[c], columns[c]));
    text += fmt::format("{}  {} \\\\\n", indent, fmt::join(cells, " & "));
  }
  return text + fmt::format("{}  \\bottomrule\n{}\\end{{tabular}}\n", indent, indent);
}

}  // namespace

std::string format_latex(const TextTable& table, bool body) {
  constexpr const char* kPackages = "% \\usepackage{booktabs, siunitx}";
  if (body) {
    std::string text = fmt::format("{}\n", kPackages);
    for (std::string note : table.notes) {
      std::ranges::replace(note, '\n', ' ');
      text += fmt::format("% {}\n", note);
    }
    return text + tabular(table, "");
  }
  std::string text = fmt::format("\\begin{{table}}  {}\n  \\centering\n", kPackages);
  const std::string title = escape_latex(fmt::format("{}", fmt::join(table.experiments, ", ")));
  text += fmt::format("  \\caption[{{{0}}}]{{{0}.", title);
  for (const std::string& note : table.notes) text += fmt::format("\n    {}", escape_latex(note));
  text += fmt::format("}}\n  \\label{{{}}}\n  \\footnotesize\n  \\setlength{{\\tabcolsep}}{{3pt}}\n", label_of(table));
  return text + tabular(table, "  ") + "\\end{table}\n";
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
        break;  // at the beginning of a row it would be an argument of the line break
      case '\n': result += ' '; break;
      default: result += c;
    }
  }
  return result;
}

}  // namespace evbench
