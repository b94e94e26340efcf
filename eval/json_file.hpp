#pragma once

#include <string>

#include "core/plugin/options.hpp"

namespace evbench {

/// The content of a file; throws InputError, naming it, when it can't be opened or is no JSON.
Json read_json_file(const std::string& path);

/// JSON as it stands in a file that people may read: indented, with a line break at its end.
std::string json_file_text(const Json& json);

}  // namespace evbench
