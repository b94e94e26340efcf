#include "core/plugin/options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <sstream>

#include "core/io/path.hpp"
#include "core/support/error.hpp"
#include "core/support/index.hpp"
#include "core/support/json.hpp"
#include "core/support/nearest.hpp"

namespace evbench {
namespace {

template <class... Ts>
struct Overloaded : Ts... {
  using Ts::operator()...;
};
template <class... Ts>
Overloaded(Ts...) -> Overloaded<Ts...>;

/// Wraps a text into lines of at most kLine characters, indented by `indent` blanks.
std::string wrapped(const std::string& text, std::size_t indent) {
  constexpr std::size_t kLine = 100;
  std::istringstream words(text);
  std::string result, line;
  const auto end_line = [&] {
    result += std::string(indent, ' ') + line + "\n";
    line.clear();
  };
  for (std::string word; words >> word;) {
    if (!line.empty() && indent + line.size() + 1 + word.size() > kLine) end_line();
    line += (line.empty() ? "" : " ") + word;
  }
  end_line();
  return result;
}

std::string shown(const Json& value) {
  std::string text = dump_json(value);
  if (text.size() > 60) text = text.substr(0, 57) + "...";
  return text;
}

/// The place of a key: "config.json: seed" in a file, "config.json: source.duration" below a key.
std::string below(const std::string& place, const std::string& key) {
  return place + (place.find(": ") == std::string::npos ? ": " : ".") + key;
}

}  // namespace

OptionSet::Option& OptionSet::Option::range(double minimum, double maximum) {
  minimum_ = minimum;
  maximum_ = maximum;
  return *this;
}

OptionSet::Option& OptionSet::Option::above(double minimum) {
  minimum_ = minimum;
  open_below_ = true;
  return *this;
}

OptionSet::Option& OptionSet::Option::choices(std::vector<std::string> values) {
  choices_ = std::move(values);
  return *this;
}

OptionSet::Option& OptionSet::Option::rising() {
  rising_ = true;
  return *this;
}

OptionSet::Option& OptionSet::Option::size(std::size_t count) {
  size_ = count;
  may_be_empty_ = std::get<List*>(target_)->empty();
  return *this;
}

OptionSet::Option& OptionSet::Option::required() {
  required_ = true;
  return *this;
}

OptionSet::Option& OptionSet::Option::path() {
  path_ = true;
  return *this;
}

OptionSet::Option& OptionSet::Option::folder() {
  path_ = folder_ = true;
  return *this;
}

std::string OptionSet::Option::allowed() const {
  if (!choices_.empty()) return fmt::format("{}", fmt::join(choices_, " | "));
  const bool bounded_below = std::isfinite(minimum_);
  const bool bounded_above = std::isfinite(maximum_);
  if (bounded_below && bounded_above) return fmt::format("{}{} to {}", open_below_ ? "above " : "", minimum_, maximum_);
  if (bounded_below) return fmt::format("{} {}", open_below_ ? ">" : ">=", minimum_);
  if (bounded_above) return fmt::format("<= {}", maximum_);
  return "";
}

std::string OptionSet::Option::type_name() const {
  return std::visit(Overloaded{[](bool*) { return "true or false"; }, [](int*) { return "integer"; },
                               [](std::int64_t*) { return "integer"; }, [](double*) { return "number"; },
                               [](std::string*) { return "text"; }, [](const Enumerator&) { return "text"; },
                               [](List*) { return "list of numbers"; }, [](Json*) { return "any"; }},
                    target_);
}

void OptionSet::Option::check_number(double number, const std::string& place) const {
  const bool too_low = open_below_ ? !(number > minimum_) : number < minimum_;
  if (!std::isfinite(number) || too_low || number > maximum_) {
    throw InputError(fmt::format("{}: {} is out of range; expected {}", place, number, allowed()));
  }
}

void OptionSet::Option::check_choice(const std::string& value, const std::string& place) const {
  if (choices_.empty() || std::ranges::find(choices_, value) != choices_.end()) return;
  throw InputError(fmt::format("{}: \"{}\" is not one of {}{}", place, value, allowed(), suggestion(value, choices_)));
}

void OptionSet::Option::read(const Json& value, const std::string& place) {
  const auto wrong_type = [&]() -> InputError {
    return InputError(fmt::format("{}: expected {}, found {}", place, type_name(), shown(value)));
  };
  const auto integer = [&]() {
    const double number = value.is_number() ? value.get<double>() : std::nan("");
    if (!(std::abs(number) < 9.0e15) || number != std::floor(number)) throw wrong_type();
    check_number(number, place);
    return static_cast<std::int64_t>(number);
  };
  std::visit(
      Overloaded{[&](bool* target) {
                   if (!value.is_boolean()) throw wrong_type();
                   *target = value.get<bool>();
                 },
                 [&](int* target) {
                   const std::int64_t number = integer();
                   if (number < std::numeric_limits<int>::min() || number > std::numeric_limits<int>::max()) {
                     throw wrong_type();
                   }
                   *target = static_cast<int>(number);
                 },
                 [&](std::int64_t* target) { *target = integer(); },
                 [&](double* target) {
                   if (!value.is_number()) throw wrong_type();
                   check_number(value.get<double>(), place);
                   *target = value.get<double>();
                 },
                 [&](std::string* target) {
                   if (!value.is_string()) throw wrong_type();
                   check_choice(value.get<std::string>(), place);
                   *target = value.get<std::string>();
                 },
                 [&](const Enumerator& target) {
                   if (!value.is_string()) throw wrong_type();
                   check_choice(value.get<std::string>(), place);
                   const auto name = std::ranges::find(choices_, value.get<std::string>());
                   target.set(target.member, static_cast<int>(name - choices_.begin()));
                 },
                 [&](List* target) {
                   if (!value.is_array()) throw wrong_type();
                   List list;
                   for (const Json& item : value) {
                     if (!item.is_number()) throw wrong_type();
                     check_number(item.get<double>(), place);
                     list.push_back(item.get<double>());
                   }
                   if (size_ && list.size() != *size_ && !(may_be_empty_ && list.empty())) {
                     throw InputError(fmt::format("{}: expected {} numbers, found {}", place, *size_, list.size()));
                   }
                   if (rising_ && std::ranges::adjacent_find(list, std::greater_equal()) != list.end()) {
                     throw InputError(fmt::format("{}: is {}; expected rising numbers", place, shown(value)));
                   }
                   *target = std::move(list);
                 },
                 [&](Json* target) { *target = value; }},
      target_);
}

Json OptionSet::Option::value() const {
  return std::visit(
      Overloaded{[](auto* target) { return Json(*target); },
                 [&](const Enumerator& target) { return Json(choices_[index(target.get(target.member))]); }},
      target_);
}

Json OptionSet::Option::schema() const {
  Json result;
  Json number = {{"type", "number"}};
  if (std::holds_alternative<int*>(target_) || std::holds_alternative<std::int64_t*>(target_)) {
    number["type"] = "integer";
  }
  if (std::isfinite(minimum_)) number[open_below_ ? "exclusiveMinimum" : "minimum"] = minimum_;
  if (std::isfinite(maximum_)) number["maximum"] = maximum_;
  std::visit(Overloaded{[&](bool*) { result["type"] = "boolean"; }, [&](int*) { result = number; },
                        [&](std::int64_t*) { result = number; }, [&](double*) { result = number; },
                        [&](std::string*) {
                          result["type"] = "string";
                          if (!choices_.empty()) result["enum"] = choices_;
                        },
                        [&](const Enumerator&) { result["enum"] = choices_; },
                        [&](List*) {
                          result["type"] = "array";
                          result["items"] = number;
                          if (!size_) return;
                          const Json sized = {{"minItems", *size_}, {"maxItems", *size_}};
                          if (may_be_empty_) result["anyOf"] = {sized, {{"maxItems", 0}}};
                          if (!may_be_empty_) result.update(sized);
                        },
                        [&](Json*) {}},
             target_);
  result["description"] = text_;
  if (!required_) result["default"] = value();
  return result;
}

OptionSet::Option& OptionSet::add(const std::string& name, Target target, const std::string& text) {
  Option option;
  option.name_ = name;
  option.text_ = text;
  option.target_ = target;
  options_.push_back(std::move(option));
  return options_.back();
}

void OptionSet::add_group(const std::string& name, const std::string& text, OptionSet set) {
  groups_.push_back({name, text, std::move(set)});
}

void OptionSet::read(const Json& object, const std::string& place) {
  if (!object.is_object()) {
    throw InputError(fmt::format("{}: expected an object {{...}}, found {}", place, shown(object)));
  }
  std::vector<std::string> known;
  for (const Option& option : options_) known.push_back(option.name_);
  for (const Group& group : groups_) known.push_back(group.name);
  for (const auto& [key, value] : object.items()) {
    if (std::ranges::find(known, key) == known.end()) {
      throw InputError(fmt::format("{}: unknown key \"{}\"{}", place, key, suggestion(key, known)));
    }
  }
  for (Option& option : options_) {
    const auto found = object.find(option.name_);
    if (found != object.end()) {
      option.read(*found, below(place, option.name_));
    } else if (option.required_) {
      throw InputError(fmt::format("{}: \"{}\" is missing ({})", place, option.name_, option.text_));
    }
  }
  for (const std::vector<std::string>& names : alternatives_) {
    const auto given = [&](const std::string& name) { return object.contains(name) && object[name] != ""; };
    if (std::ranges::any_of(names, given)) continue;
    throw InputError(fmt::format("{}: expected at least one of {}", place, fmt::join(names, ", ")));
  }
  for (Group& group : groups_) {
    const auto found = object.find(group.name);
    if (found != object.end()) group.set.read(*found, below(place, group.name));
  }
}

void OptionSet::anchor_paths(const std::string& folder) {
  for (Option& option : options_) {
    auto* const* path = std::get_if<std::string*>(&option.target_);
    if (option.path_ && path != nullptr && !(*path)->empty()) **path = anchored_path(**path, folder);
  }
  for (Group& group : groups_) group.set.anchor_paths(folder);
}

Json OptionSet::write() const {
  Json result = Json::object();
  for (const Option& option : options_) result[option.name_] = option.value();
  for (const Group& group : groups_) result[group.name] = group.set.write();
  return result;
}

Json OptionSet::write_without_paths() const {
  Json result = Json::object();
  for (const Option& option : options_) {
    if (!option.path_) result[option.name_] = option.value();
  }
  for (const Group& group : groups_) result[group.name] = group.set.write_without_paths();
  return result;
}

std::vector<std::string> OptionSet::paths() const {
  std::vector<std::string> result;
  for (const Option& option : options_) {
    const auto* const* path = std::get_if<std::string*>(&option.target_);
    if (option.path_ && !option.folder_ && path != nullptr && !(*path)->empty()) result.push_back(**path);
  }
  for (const Group& group : groups_) {
    for (std::string& path : group.set.paths()) result.push_back(std::move(path));
  }
  return result;
}

Json OptionSet::schema() const {
  Json properties = Json::object();
  Json required = Json::array();
  for (const Option& option : options_) {
    properties[option.name_] = option.schema();
    if (option.required_) required.push_back(option.name_);
  }
  for (const Group& group : groups_) {
    properties[group.name] = group.set.schema();
    properties[group.name]["description"] = group.text;
  }
  Json result = {{"type", "object"}, {"properties", properties}, {"additionalProperties", false}};
  if (!required.empty()) result["required"] = required;
  for (const std::vector<std::string>& names : alternatives_) {
    Json any = Json::array();
    for (const std::string& name : names) {
      any.push_back({{"required", {name}}, {"properties", {{name, {{"minLength", 1}}}}}});
    }
    result["allOf"].push_back({{"anyOf", any}});
  }
  return result;
}

void OptionSet::describe_rows(const std::string& prefix, std::vector<std::array<std::string, 4>>& rows) const {
  for (const Option& option : options_) {
    const std::string allowed = option.allowed();
    rows.push_back({prefix + option.name_, option.required_ ? "required" : shown(option.value()),
                    allowed.empty() ? option.type_name() : allowed, option.text_});
  }
  for (const Group& group : groups_) {
    rows.push_back({prefix + group.name + ".", "", "", group.text});  // a heading
    group.set.describe_rows(prefix + group.name + ".", rows);
  }
}

std::string OptionSet::describe() const {
  std::vector<std::array<std::string, 4>> rows = {{"option", "default", "allowed", "what it does"}};
  describe_rows("", rows);
  std::string text;
  for (const auto& [name, value, allowed, what] : rows) {
    if (value.empty()) {
      text += "\n" + wrapped(fmt::format("{} {}", name, what), 0);
    } else {
      text += wrapped(fmt::format("{} = {}  ({})", name, value, allowed), 2) + wrapped(what, 6);
    }
  }
  return text;
}

}  // namespace evbench
