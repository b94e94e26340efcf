#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "core/support/error.hpp"
#include "core/support/nearest.hpp"

namespace evbench {

/// The names of an enumeration's values 0, 1, 2, ... in configs and results.
template <std::size_t N>
using NameList = std::array<const char*, N>;

template <std::size_t N>
std::vector<std::string> to_strings(const NameList<N>& names) {
  return {names.begin(), names.end()};
}

/// The value of that name. Throws InputError with the nearest name. `what`: what is named, e.g. "alignment".
template <class Enum, std::size_t N>
Enum parse_name(const NameList<N>& names, const std::string& name, const char* what) {
  const std::vector<std::string> known = to_strings(names);
  const auto found = std::ranges::find(known, name);
  if (found == known.end()) {
    throw InputError(fmt::format("unknown {} \"{}\"{}", what, name, suggestion(name, known)));
  }
  return static_cast<Enum>(found - known.begin());
}

}  // namespace evbench
