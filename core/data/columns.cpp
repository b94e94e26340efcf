#include "core/data/columns.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <regex>

namespace evbench {
namespace {

/// Names as they stand between separators; blanks separate where nothing else does, but for a unit's bracket.
std::vector<std::string> split_names(std::string_view line) {
  const bool by_blanks = line.find_first_of(",;") == std::string_view::npos;
  std::vector<std::string> names(1);
  int depth = 0;
  for (const char c : line) {
    if (c == '[' || c == '(') ++depth;
    if (c == ']' || c == ')') --depth;
    const bool blank = c == ' ' || c == '\t';
    if (depth <= 0 && (by_blanks ? blank : c == ',' || c == ';')) {
      names.emplace_back();
    } else {
      names.back() += c;
    }
  }
  if (!by_blanks) return names;
  std::vector<std::string> whole;  // runs of blanks, and a unit behind one
  for (std::string& name : names) {
    if (!whole.empty() && (name.starts_with('[') || name.starts_with('('))) {
      whole.back() += name;
    } else if (!name.empty()) {
      whole.push_back(std::move(name));
    }
  }
  return whole;
}

struct Name {
  std::string words;  ///< in lower case, with _ between them
  TimeUnit unit = TimeUnit::unsaid;
};

Name read_name(const std::string& name_in_file) {
  const std::string text = with_plain_micro(name_in_file);
  const std::size_t bracket = std::min(text.find_first_of("[("), text.size());
  Name name;
  for (const char c : text.substr(0, bracket)) {
    const bool letter = std::isalnum(static_cast<unsigned char>(c)) != 0;
    if (letter) {
      name.words += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    } else if (!name.words.empty() && name.words.back() != '_') {
      name.words += '_';
    }
  }
  if (name.words.ends_with('_')) name.words.pop_back();
  std::string unit = text.substr(bracket);
  if (const std::size_t last = name.words.rfind('_'); unit.empty() && last != std::string::npos) {
    unit = name.words.substr(last + 1);
    if (parse_time_unit(unit)) name.words.resize(last);
  }
  name.unit = parse_time_unit(unit).value_or(TimeUnit::unsaid);
  return name;
}

bool is_number(std::string_view column) {
  const std::string text(column);
  char* end = nullptr;
  std::strtod(text.c_str(), &end);
  return !text.empty() && *end == '\0';
}

/// Without the mark of a comment.
std::string_view bare(std::string_view line) {
  return line.substr(std::min(line.find_first_not_of("#% \t"), line.size()));
}

}  // namespace

Columns::Columns(std::string_view names, std::span<const Quantity> quantities) {
  constexpr std::size_t kLongest = 64;  // std::regex takes stack by the length, and nobody's names are longer
  std::vector<std::regex> aliases;
  for (const Quantity& quantity : quantities) aliases.emplace_back(quantity.aliases);
  for (const std::string& text : split_names(bare(names))) {
    const Name name = read_name(text);
    const auto known = std::ranges::find_if(quantities, [&](const Quantity& quantity) {
      return name.words.size() <= kLongest && !find(quantity.name) &&
             std::regex_match(name.words, aliases[static_cast<std::size_t>(&quantity - quantities.data())]);
    });
    quantities_.emplace_back(known == quantities.end() ? "" : known->name);
    if (quantities_.back() == kTime.name) time_unit_ = name.unit;
  }
}

std::optional<std::size_t> Columns::find(std::string_view quantity) const {
  const auto found = std::ranges::find(quantities_, quantity);
  if (found == quantities_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - quantities_.begin());
}

std::vector<std::size_t> Columns::find_all(std::span<const Quantity> quantities) const {
  std::vector<std::size_t> columns;
  for (const Quantity& quantity : quantities) {
    const auto column = find(quantity.name);
    if (!column) return {};
    columns.push_back(*column);
  }
  return columns;
}

std::string Columns::text() const {
  std::vector<std::string> names = quantities_;
  std::ranges::replace(names, "", "-");
  return fmt::to_string(fmt::join(names, " "));
}

Columns Columns::followed_to(std::size_t size) const {
  Columns columns = *this;
  columns.quantities_.resize(std::max(size, this->size()));
  return columns;
}

std::optional<Columns> read_names(TextReader& reader, std::span<const Quantity> quantities,
                                  const std::function<bool(const Columns&)>& complete, const std::string& expected) {
  if (std::ranges::any_of(reader.columns(), is_number)) {
    Columns columns(reader.comment(), quantities);
    if (columns.size() == reader.columns().size() && complete(columns)) return columns;
    return std::nullopt;
  }
  Columns columns(reader.text(), quantities);
  if (!complete(columns)) {
    reader.fail(
        fmt::format("names the columns \"{:.80}\"; expected names such as {}, or numbers", reader.text(), expected));
  }
  reader.next();
  return columns;
}

TimeColumn::TimeColumn(const TextReader& reader, std::size_t column, TimeUnit asked, TimeUnit named)
    : column_(column), unit_(asked != TimeUnit::unsaid ? asked : named) {
  if (unit_ != TimeUnit::unsaid) return;
  const double time = reader.number(column, "the time");
  const auto usual = usual_time_unit(time);
  if (!usual) {
    reader.fail(
        fmt::format("the time is {}, too late for seconds; expected its unit, as an option or in the column's "
                    "name, e.g. t_us",
                    time));
  }
  unit_ = *usual;
}

}  // namespace evbench
