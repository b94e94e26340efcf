#include "core/data/columns.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <regex>

namespace evbench {
namespace {

/// Splits names at separators; at blanks if there are no others, but not before a unit in brackets.
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
  std::vector<std::string> whole;  // blanks in a row are one separator; a unit in brackets belongs to its name
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
  std::string text;   ///< as in the file
  std::string words;  ///< in lower case, with _ between them, without a unit of time
  std::string unit_word;
  TimeUnit unit = TimeUnit::unsaid;
};

Name read_name(const std::string& name_in_file) {
  constexpr std::size_t kShortestWord = 3;  // a bare unit such as "sec" is a time; "s" is ambiguous
  const std::string text = with_plain_micro(name_in_file);
  const std::size_t bracket = std::min(text.find_first_of("[("), text.size());
  Name name;
  name.text = text.substr(std::min(text.find_first_not_of(" \t"), text.size()));
  for (const char c : text.substr(0, bracket)) {
    const bool letter = std::isalnum(static_cast<unsigned char>(c)) != 0;
    if (letter) {
      name.words += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    } else if (!name.words.empty() && name.words.back() != '_') {
      name.words += '_';
    }
  }
  if (name.words.ends_with('_')) name.words.pop_back();
  const std::size_t last = name.words.rfind('_');
  const bool alone = last == std::string::npos;
  const std::string word = alone ? name.words : name.words.substr(last + 1);
  if (const auto unit = parse_time_unit(word); unit && !(alone && word.size() < kShortestWord)) {
    name.words = alone ? kTime.name : name.words.substr(0, last);
    name.unit_word = word;
    name.unit = *unit;
  }
  if (const auto unit = parse_time_unit(text.substr(bracket))) name.unit = *unit;
  return name;
}

/// Are these the two parts of a ROS stamp, in this order?
bool are_parts(const Name& whole, const Name& rest) {
  const auto is = [](const std::string& word, std::initializer_list<const char*> words) {
    return std::ranges::any_of(words, [&](const char* known) { return word == known; });
  };
  return whole.words == rest.words && is(whole.unit_word, {"sec", "secs"}) &&
         is(rest.unit_word, {"nsec", "nsecs", "nanosec", "nanosecs"});
}

bool is_number(std::string_view column) {
  const std::string text(column);
  char* end = nullptr;
  std::strtod(text.c_str(), &end);
  return !text.empty() && *end == '\0';
}

/// Is the present record a line of names?
bool names_columns(const TextReader& reader) { return std::ranges::none_of(reader.columns(), is_number); }

/// The line without a comment mark.
std::string_view bare(std::string_view line) {
  return line.substr(std::min(line.find_first_not_of("#% \t"), line.size()));
}

}  // namespace

Columns::Columns(std::string_view line, std::span<const Quantity> quantities) {
  constexpr std::size_t kLongest = 64;  // std::regex needs stack in proportion to the length; real names are shorter
  std::vector<Name> names;
  for (const std::string& text : split_names(bare(line))) names.push_back(read_name(text));
  quantities_.resize(names.size());
  for (const Quantity& quantity : quantities) {
    const std::regex aliases(quantity.aliases), preferred(quantity.preferred == nullptr ? "" : quantity.preferred);
    std::vector<std::size_t> fitting, best;
    for (std::size_t i = 0; i < names.size(); ++i) {
      const std::string& words = names[i].words;
      if (!quantities_[i].empty() || words.size() > kLongest || !std::regex_match(words, aliases)) continue;
      fitting.push_back(i);
      if (std::regex_match(words, preferred)) best.push_back(i);
    }
    if (!best.empty()) fitting = best;
    if (fitting.empty()) continue;
    const bool is_time = std::string_view(quantity.name) == kTime.name;
    if (is_time && fitting.size() == 2) {
      if (are_parts(names[fitting[1]], names[fitting[0]])) std::swap(fitting[0], fitting[1]);
      if (are_parts(names[fitting[0]], names[fitting[1]])) {
        nanoseconds_ = fitting[1];
        fitting.pop_back();
      }
    }
    quantities_[fitting.front()] = quantity.name;
    if (is_time) time_unit_ = names[fitting.front()].unit;
    if (fitting.size() > 1 && ambiguity_.empty()) {
      ambiguity_ = fmt::format("\"{:.80}\" and \"{:.80}\", either of which may be {}", names[fitting[0]].text,
                               names[fitting[1]].text, quantity.name);
    }
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

Columns Columns::in_order(std::span<const Quantity> quantities) const {
  Columns columns = *this;
  auto next = quantities.begin();
  for (std::string& name : columns.quantities_) {
    const auto known = std::ranges::find(quantities, name, [](const Quantity& quantity) { return quantity.name; });
    if (known != quantities.end()) name = (next++)->name;
  }
  return columns;
}

Columns Columns::followed_to(std::size_t size) const {
  Columns columns = *this;
  columns.quantities_.resize(std::max(size, this->size()));
  return columns;
}

std::optional<Columns> read_names(TextReader& reader, std::span<const Quantity> quantities,
                                  const std::function<bool(const Columns&)>& complete, const std::string& expected) {
  const bool in_record = names_columns(reader);
  Columns columns(in_record ? reader.text() : reader.comment(), quantities);
  const bool all = complete(columns);
  if (!in_record && !(all && columns.size() == reader.columns().size())) return std::nullopt;
  if (!all) {
    reader.fail(
        fmt::format("names the columns \"{:.80}\"; expected names such as {}, or numbers", reader.text(), expected));
  }
  if (!columns.ambiguity().empty()) {
    reader.fail(fmt::format("the columns are named {}; expected only one of them", columns.ambiguity()));
  }
  if (in_record) reader.next();
  return columns;
}

void pass_over_names(TextReader& reader) {
  if (names_columns(reader)) reader.next();
}

TimeColumn::TimeColumn(const TextReader& reader, const Columns& columns, TimeUnit asked)
    : column_(*columns.find(kTime.name)),
      nanoseconds_(columns.nanoseconds()),
      unit_(asked == TimeUnit::unsaid || nanoseconds_ ? columns.time_unit() : asked),
      guessed_(unit_ == TimeUnit::unsaid) {
  if (guessed_) unit_ = usual_time_unit(count(reader)).value_or(TimeUnit::unsaid);
}

void TimeColumn::expect_unit(const TextReader& reader) const {
  if (unit_ == TimeUnit::unsaid) reader.fail(unknown_time_unit(count(reader)));
}

double TimeColumn::count(const TextReader& reader) const {
  if (!nanoseconds_) return reader.number(column_, "the time");
  const std::int64_t seconds = reader.integer(column_, "the time's seconds");
  const std::int64_t rest = reader.integer(*nanoseconds_, "the time's nanoseconds");
  if (rest < 0 || rest >= 1'000'000'000) {
    reader.fail(fmt::format("the time's nanoseconds are {}; expected 0 to 999999999, with whole seconds", rest));
  }
  return static_cast<double>(seconds) + 1e-9 * static_cast<double>(rest);
}

std::string unknown_time_unit(double time) {
  return fmt::format(
      "the time is {}, too late for seconds; expected its unit, as an option or in the column's name, e.g. t_us", time);
}

}  // namespace evbench
