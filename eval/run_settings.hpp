#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/plugin/options.hpp"
#include "core/support/json.hpp"

namespace evbench {

/// Values by path in a config ("backend.batch_duration"), in its order.
using RunSettings = std::vector<std::pair<std::string, Json>>;

/// A run's place in a sweep: the names of its axes, and its values on them as text.
using RunAxes = std::vector<std::pair<std::string, std::string>>;

/// The settings of source, front-end, back-end and pipeline in a run's config.json: all that may make two runs of one
/// label differ, except the seed.
RunSettings settings_of(const Json& config);

/// Null if the settings don't have it.
const Json* find_setting(const RunSettings& settings, const std::string& path);

/// The value as tables show it; empty if the settings don't have it.
std::string setting_text(const RunSettings& settings, const std::string& path);

/// Whether the values of `a` are before those of `b`. Numbers compare as numbers.
bool settings_less(const RunSettings& a, const RunSettings& b);

}  // namespace evbench
