#pragma once

#include <string>

#include "core/plugin/options.hpp"

namespace evbench {

/// Reads a JSON file. Throws InputError with its name if it can't be opened or is not JSON.
Json read_json_file(const std::string& path);

/// JSON as text for a file: indented, with a line break at its end.
std::string json_file_text(const Json& json);

}  // namespace evbench
