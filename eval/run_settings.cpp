#include "eval/run_settings.hpp"

#include <algorithm>

namespace evbench {
namespace {

void add_values(const Json& node, const std::string& path, RunSettings& settings) {
  if (!node.is_object()) {
    settings.emplace_back(path, node);
    return;
  }
  for (const auto& [key, value] : node.items()) add_values(value, path + "." + key, settings);
}

}  // namespace

RunSettings settings_of(const Json& config) {
  RunSettings settings;
  for (const char* key : {"trajectory_rate", "source", "frontend", "backend", "pipeline"}) {
    const auto found = config.find(key);
    if (found != config.end()) add_values(*found, key, settings);
  }
  std::erase_if(settings, [](const auto& setting) {  // neither changes a result
    return setting.first == "backend.label" || setting.first == "source.cache";
  });
  return settings;
}

const Json* find_setting(const RunSettings& settings, const std::string& path) {
  const auto found = std::ranges::find(settings, path, &RunSettings::value_type::first);
  return found == settings.end() ? nullptr : &found->second;
}

std::string setting_text(const RunSettings& settings, const std::string& path) {
  const Json* value = find_setting(settings, path);
  if (value == nullptr || value->is_null()) return "";
  return value->is_string() ? value->get<std::string>() : value->dump();
}

bool settings_less(const RunSettings& a, const RunSettings& b) {
  return std::ranges::lexicographical_compare(
      a, b, [](const auto& x, const auto& y) { return x.first != y.first ? x.first < y.first : x.second < y.second; });
}

}  // namespace evbench
