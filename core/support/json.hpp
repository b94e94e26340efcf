#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "core/support/json_fwd.hpp"

namespace evbench {

// Parsing and printing, compiled once: each takes seconds to compile in a source.

/// Parses JSON. Throws Json::parse_error for invalid text.
Json parse_json(std::string_view text);

/// The same; for invalid text the result is_discarded().
Json try_parse_json(std::string_view text);

/// Prints JSON. `indent`: blanks per level; −1: one line. Throws Json::type_error for text that is not UTF-8.
std::string dump_json(const Json& json, int indent = -1);

/// The same on one line, with invalid UTF-8 replaced by U+FFFD.
std::string printable_json(const Json& json);

}  // namespace evbench
