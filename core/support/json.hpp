#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "core/support/json_fwd.hpp"

namespace evbench {

// Parsing and printing, compiled once: each costs a source that does it by itself seconds of compiling.

/// Throws Json::parse_error where the text is no JSON.
Json parse_json(std::string_view text);

/// Where the text is no JSON, what is returned is_discarded().
Json try_parse_json(std::string_view text);

/// `indent`: blanks a level; −1: all on one line. Throws Json::type_error for text that is not UTF-8.
std::string dump_json(const Json& json, int indent = -1);

/// What is not UTF-8 is replaced by U+FFFD.
std::string printable_json(const Json& json);

}  // namespace evbench
