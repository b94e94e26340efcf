#pragma once

#include <fmt/format.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/plugin/options.hpp"
#include "core/support/error.hpp"
#include "core/support/json.hpp"

namespace evbench {

/// Reads an object of metrics.json or sweep.json key by key. Errors name the place, the key and the expected value.
class RecordReader {
 public:
  RecordReader(const Json& object, std::string place) : object_(object), place_(std::move(place)) {
    if (!object.is_object()) throw InputError(fmt::format("{}: expected a JSON object", place_));
  }

  const std::string& place() const { return place_; }

  /// Null if the key is missing.
  const Json& at(const char* key) const {
    static const Json null;
    const auto found = object_.find(key);
    return found == object_.end() ? null : *found;
  }

  /// Required text.
  std::string text(const char* key) const {
    if (!at(key).is_string()) fail(key, "text");
    return at(key).get<std::string>();
  }
  std::string text_or(const char* key, const std::string& otherwise) const {
    return at(key).is_null() ? otherwise : text(key);
  }

  /// A required number.
  double number(const char* key) const {
    if (!at(key).is_number()) fail(key, "a number");
    return at(key).get<double>();
  }
  std::optional<double> number_or_null(const char* key) const {
    return at(key).is_null() ? std::nullopt : std::optional(number(key));
  }

  /// A whole number from 0 on.
  std::optional<std::uint64_t> count_or_null(const char* key) const {
    if (at(key).is_null()) return std::nullopt;
    if (!at(key).is_number_unsigned()) fail(key, "a whole number from 0 on");
    return at(key).get<std::uint64_t>();
  }

  bool flag_or(const char* key, bool otherwise) const {
    if (at(key).is_null()) return otherwise;
    if (!at(key).is_boolean()) fail(key, "true or false");
    return at(key).get<bool>();
  }

  /// The items of a list of objects; empty if it is missing.
  std::vector<RecordReader> list(const char* key) const {
    std::vector<RecordReader> items;
    if (at(key).is_null()) return items;
    if (!at(key).is_array()) fail(key, "a list");
    for (std::size_t i = 0; i < at(key).size(); ++i) {
      items.emplace_back(at(key)[i], fmt::format("{}: {}.{}", place_, key, i));
    }
    return items;
  }

  [[noreturn]] void fail(const char* key, const char* expected) const {
    throw InputError(fmt::format("{}: \"{}\" is {}; expected {}", place_, key,
                                 at(key).is_null() ? "missing" : dump_json(at(key)), expected));
  }

 private:
  const Json& object_;
  std::string place_;
};

}  // namespace evbench
