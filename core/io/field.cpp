#include "core/io/field.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <cstdlib>

#include "core/io/byte_source.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

using Json = nlohmann::json;

std::string read_text(const std::string& path) {
  constexpr std::uint64_t kMost = 1 << 20;
  return read_small_file(path, kMost, "a calibration");
}

/// Converts YAML to JSON. A scalar that looks like a number is one. Aliases are expanded; at most `most` values in all
/// and 100 levels.
Json to_json(const YAML::Node& node, std::size_t& most, int depth = 0) {
  constexpr int kDeepest = 100;
  if (most-- == 0 || depth > kDeepest)
    throw YAML::Exception(node.Mark(), "more values or levels than a calibration has");
  switch (node.Type()) {
    case YAML::NodeType::Map: {
      Json map = Json::object();
      for (const auto& entry : node) map[entry.first.as<std::string>()] = to_json(entry.second, most, depth + 1);
      return map;
    }
    case YAML::NodeType::Sequence: {
      Json list = Json::array();
      for (const YAML::Node& value : node) list.push_back(to_json(value, most, depth + 1));
      return list;
    }
    case YAML::NodeType::Scalar: {
      const std::string& text = node.Scalar();
      char* end = nullptr;
      const double number = std::strtod(text.c_str(), &end);
      if (!text.empty() && *end == '\0') return number;
      return text;
    }
    case YAML::NodeType::Null:
    case YAML::NodeType::Undefined: break;
  }
  return nullptr;
}

}  // namespace

Field Field::read_json(const std::string& path) {
  Json json = Json::parse(read_text(path), nullptr, false);
  if (json.is_discarded()) throw InputError(fmt::format("{}: is not JSON; expected a calibration", path));
  auto file = std::make_shared<const Json>(std::move(json));
  return {file, file.get(), path};
}

Field Field::read_yaml(const std::string& path) {
  constexpr std::size_t kMostValues = 100'000;
  try {
    std::size_t most = kMostValues;
    auto file = std::make_shared<const Json>(to_json(YAML::Load(read_text(path)), most));
    return {file, file.get(), path};
  } catch (const YAML::Exception& error) {
    throw InputError(fmt::format("{}:{}: is not the YAML of a calibration: {}", path, error.mark.line + 1, error.msg));
  }
}

Field Field::at(const std::string& key) const {
  if (!has(key)) throw InputError(fmt::format("{}: has no {}; expected a calibration with it", place_, key));
  return {file_, &(*value_)[key], fmt::format("{}: {}", place_, key)};
}

Field Field::at(std::size_t index) const {
  if (!value_->is_array() || index >= value_->size()) {
    fail(fmt::format("is {}; expected a list of at least {}",
                     value_->is_array() ? fmt::format("a list of {}", value_->size()) : value_->type_name(),
                     index + 1));
  }
  return {file_, &(*value_)[index], fmt::format("{}[{}]", place_, index)};
}

double Field::number() const {
  const double number = value_->is_number() ? value_->get<double>() : std::nan("");
  if (!std::isfinite(number)) fail(fmt::format("is {}; expected a number", value_->dump()));
  return number;
}

std::vector<std::string> Field::keys() const {
  std::vector<std::string> keys;
  if (is_map()) {
    for (const auto& [key, value] : value_->items()) keys.push_back(key);
  }
  return keys;
}

std::vector<double> Field::numbers() const {
  if (!value_->is_array()) fail(fmt::format("is {}; expected a list of numbers", value_->type_name()));
  std::vector<double> numbers;
  for (std::size_t i = 0; i < value_->size(); ++i) numbers.push_back(at(i).number());
  return numbers;
}

std::vector<double> Field::numbers(std::size_t count) const {
  if (!value_->is_array() || value_->size() != count) {
    fail(fmt::format("is {}; expected {} numbers",
                     value_->is_array() ? fmt::format("a list of {}", value_->size()) : value_->type_name(), count));
  }
  return numbers();
}

std::string Field::text() const {
  if (!value_->is_string()) fail(fmt::format("is {}; expected text", value_->dump()));
  return value_->get<std::string>();
}

void Field::fail(const std::string& message) const { throw InputError(fmt::format("{}: {}", place_, message)); }

}  // namespace evbench
