#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <vector>

#include "core/support/nearest.hpp"

namespace evbench {

/// Checks an option that accepts only some names. Unlike CLI::IsMember its message suggests the nearest one.
inline CLI::Validator one_of(const std::vector<std::string>& names) {
  const auto check = [names](const std::string& text) {
    if (std::ranges::find(names, text) != names.end()) return std::string();
    return fmt::format("\"{}\" is none of its names{}", text, suggestion(text, names));
  };
  return {check, fmt::format("{{{}}}", fmt::join(names, ","))};
}

}  // namespace evbench
